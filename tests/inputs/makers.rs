//! Files as other programs write them, byte by byte: those that no writer here would write.

use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::{Cursor, Write};

/// A subelement of a `.mat`: tag, data, fill.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// A variable: a column of `rows` numbers of a class, stored as a type.
pub fn variable(name: &str, class: u32, stored: u32, rows: usize, data: &[u8]) -> Vec<u8> {
    let flags = [class.to_le_bytes(), [0; 4]].concat();
    let size = [(rows as i32).to_le_bytes(), 1i32.to_le_bytes()].concat();
    element(14, &[element(6, &flags), element(5, &size), element(1, name.as_bytes()), element(stored, data)].concat())
}

/// A column of doubles.
pub fn doubles(name: &str, values: &[f64]) -> Vec<u8> {
    variable(name, 6, 9, values.len(), &values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>())
}

/// What `save -v7` makes of a variable.
pub fn packed(variable: &[u8]) -> Vec<u8> {
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::new(6));
    packer.write_all(variable).unwrap();
    let packed = packer.finish().unwrap();
    [&15u32.to_le_bytes()[..], &(packed.len() as u32).to_le_bytes(), &packed].concat()
}

/// A `.mat` of version 5.
pub fn mat(variables: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
    bytes.resize(124, b' ');
    bytes.extend(b"\x00\x01IM");
    bytes.extend(variables.concat());
    bytes
}

/// An HDF5 file whose root holds `links` hard links to itself, after its own format (superblock 0, object header 1).
pub fn linked_to_itself(links: usize) -> Vec<u8> {
    const ROOT: u64 = 96;
    let message = |kind: u16, data: &[u8]| {
        let mut data = data.to_vec();
        data.resize(data.len().next_multiple_of(8), 0);
        [&kind.to_le_bytes()[..], &(data.len() as u16).to_le_bytes(), &[0; 4], &data].concat()
    };
    let link_info = message(2, &[&[0, 0][..], &[0xff; 16]].concat());
    let link = |at: usize| {
        let name = format!("g{at}");
        message(6, &[&[1, 0, name.len() as u8][..], name.as_bytes(), &ROOT.to_le_bytes()].concat())
    };
    let messages: Vec<u8> = link_info.into_iter().chain((0..links).flat_map(link)).collect();
    let count = (links as u16 + 1).to_le_bytes();
    let size = (messages.len() as u32).to_le_bytes();
    let header = [&[1, 0][..], &count, &1u32.to_le_bytes(), &size, &[0; 4], &messages].concat();
    let end = (ROOT + header.len() as u64).to_le_bytes();
    let (nowhere, zero) = ([0xff; 8], [0; 8]);
    let superblock = [&b"\x89HDF\r\n\x1a\n"[..], &[0, 0, 0, 0, 0, 8, 8, 0, 4, 0, 16, 0, 0, 0, 0, 0]].concat();
    let superblock = [&superblock[..], &zero, &nowhere, &end, &nowhere, &zero, &ROOT.to_le_bytes(), &[0; 24]].concat();
    [superblock, header].concat()
}

/// A joint state in CDR.
pub fn joint_state(stamp_s: i32, names: &[String], position: &[f64]) -> Vec<u8> {
    let mut body: Vec<u8> = Vec::new();
    let align = |body: &mut Vec<u8>, to: usize| body.resize(body.len().next_multiple_of(to), 0);
    body.extend(stamp_s.to_le_bytes());
    body.extend(500u32.to_le_bytes());
    body.extend([1, 0, 0, 0, 0, 0, 0, 0]);
    body.truncate(13);
    align(&mut body, 4);
    body.extend((names.len() as u32).to_le_bytes());
    for name in names {
        align(&mut body, 4);
        body.extend((name.len() as u32 + 1).to_le_bytes());
        body.extend(name.as_bytes());
        body.push(0);
    }
    align(&mut body, 4);
    body.extend((position.len() as u32).to_le_bytes());
    if !position.is_empty() {
        align(&mut body, 8);
        body.extend(position.iter().flat_map(|x| x.to_le_bytes()));
    }
    align(&mut body, 4);
    body.extend([0; 8]);
    [&[0, 1, 0, 0][..], &body].concat()
}

/// A recording of such messages, and of messages of `zeros` zeros on another topic.
pub fn recording(compression: Option<mcap::Compression>, messages: &[Vec<u8>], zeros: &[usize]) -> Vec<u8> {
    let options = mcap::WriteOptions::new().compression(compression).chunk_size(Some(1 << 20));
    let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
    let schema = writer.add_schema("sensor_msgs/msg/JointState", "ros2msg", b"").unwrap();
    let states = writer.add_channel(schema, "/joint_states", "cdr", &Default::default()).unwrap();
    let other = writer.add_channel(0, "/image", "cdr", &Default::default()).unwrap();
    let mut put = |channel_id: u16, at: usize, data: &[u8]| {
        let time = at as u64 * 1_000_000;
        let header = mcap::records::MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, data).unwrap();
    };
    messages.iter().enumerate().for_each(|(at, message)| put(states, at, message));
    zeros.iter().enumerate().for_each(|(at, zeros)| put(other, at, &vec![0; *zeros]));
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}
