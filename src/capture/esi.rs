//! Devices as their makers describe them: EtherCAT slave information files (ESI, ETG.2000).
//!
//! Taken from a file are vendor, product code, revision and name of each device, whether it has a clock (`Dc`) and how that should pulse
//! (its first `OpMode` that pulses at all), and the PDOs that it exchanges unless told otherwise: those with a sync manager (`Sm`), with
//! their entries. What a device on the bus reports always
//! counts; an ESI file serves before it is there.

use super::found::{Found, entry};
use super::rig::{Entry, Kind, Pdo, ProcessData, Pulses};
use crate::document::bytes;
use crate::limits::ESI_BYTES;
use crate::problem::{Problem, Result};
use encoding_rs::{Encoding, UTF_8};
use quick_xml::Reader;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesStart, Event};
use std::path::Path;

/// Bytes of a file that hold its XML declaration.
const HEAD_BYTES: usize = 200;

/// The devices that `file` describes, in its order; their place is their number there.
///
/// Errors: it cannot be read, is no ESI file, or a number in it cannot be read.
pub fn read(file: &Path) -> Result<Vec<Found>> {
    let bytes = bytes(file, ESI_BYTES)?;
    // A byte order mark counts for more than what the file declares.
    let (text, _, _) = encoding(&bytes).decode(&bytes);
    parse(&text).or_else(|(row, what)| {
        let cure = "name an EtherCAT slave information file (ESI, XML) as the maker publishes it";
        Problem::error(file, what, cure).at_row(row).alone()
    })
}

/// The encoding that an XML file declares in its first line, else UTF-8.
fn encoding(bytes: &[u8]) -> &'static Encoding {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD_BYTES)]);
    let declared = head.split_once("encoding=").map(|(_, rest)| rest.trim_start_matches(['"', '\'']));
    let label = declared.and_then(|label| label.split(['"', '\'']).next());
    label.and_then(|label| Encoding::for_label(label.as_bytes())).unwrap_or(UTF_8)
}

/// The same of a file's text.
///
/// Errors: the row, and what is wrong there.
fn parse(text: &str) -> std::result::Result<Vec<Found>, (u64, String)> {
    let mut reader = Reader::from_str(text);
    let mut open = Open::default();
    loop {
        let event = reader.read_event();
        let done = match event {
            Ok(Event::Eof) => break,
            Ok(Event::Start(start)) => open.begin(&start),
            Ok(Event::Empty(start)) => open.begin(&start).and_then(|()| open.end()),
            Ok(Event::End(_)) => open.end(),
            Ok(Event::Text(part)) => {
                open.text.push_str(&part.decode().unwrap_or_default());
                Ok(())
            }
            Ok(Event::CData(part)) => {
                open.text.push_str(&part.decode().unwrap_or_default());
                Ok(())
            }
            Ok(Event::GeneralRef(part)) => {
                open.text.extend(part.resolve_char_ref().ok().flatten());
                open.text.push_str(part.decode().ok().and_then(|name| resolve_predefined_entity(&name)).unwrap_or(""));
                Ok(())
            }
            Ok(_) => Ok(()),
            Err(error) => Err(format!("is no XML: {error}")),
        };
        done.map_err(|what| (row_of(text, reader.buffer_position()), what))?;
    }
    if !open.is_esi {
        return Err((1, "is no ESI file: it has no element `EtherCATInfo`".to_string()));
    }
    Ok(open.devices)
}

/// The row, from 1, of the byte `at` of `text`.
fn row_of(text: &str, at: u64) -> u64 {
    let before = text.bytes().take(usize::try_from(at).unwrap_or(usize::MAX));
    1 + before.filter(|byte| *byte == b'\n').count() as u64
}

/// Where the reader is.
#[derive(Debug, Default)]
struct Open {
    is_esi: bool,
    path: Vec<String>,
    text: String,
    vendor: u32,
    devices: Vec<Found>,
    /// The PDO that is open, and whether the device exchanges it by default.
    pdo: Option<(Pdo, bool)>,
    entry: EntryText,
    /// The clock's mode that is open.
    mode: Pulses,
}

/// An entry of a PDO as it is written there.
#[derive(Debug, Default)]
struct EntryText {
    index: u32,
    sub: u32,
    bits: u32,
    kind: String,
}

impl Open {
    fn begin(&mut self, start: &BytesStart<'_>) -> std::result::Result<(), String> {
        let name = String::from_utf8_lossy(start.local_name().as_ref()).into_owned();
        let attribute = |key: &str| {
            let found = start.attributes().flatten().find(|attribute| attribute.key.as_ref() == key.as_bytes());
            found.map(|attribute| String::from_utf8_lossy(&attribute.value).into_owned())
        };
        let number_of = |key: &str| attribute(key).map_or(Ok(0), |text| number(&text));
        self.path.push(name);
        self.text.clear();
        let path = self.path.clone();
        let at: Vec<&str> = path.iter().map(String::as_str).collect();
        match at[..] {
            ["EtherCATInfo"] => self.is_esi = true,
            [.., "Devices", "Device"] => self.devices.push(Found {
                place: self.devices.len(),
                name: String::new(),
                vendor: self.vendor,
                product: 0,
                revision: 0,
                serial: 0,
                alias: 0,
                has_clock: false,
                clock: None,
                inputs: ProcessData::default(),
                outputs: ProcessData::default(),
            }),
            [.., "Device", "Type"] => {
                let (product, revision) = (number_of("ProductCode")?, number_of("RevisionNo")?);
                if let Some(device) = self.devices.last_mut() {
                    (device.product, device.revision) = (product, revision);
                }
            }
            [.., "Device", "Dc"] => {
                if let Some(device) = self.devices.last_mut() {
                    device.has_clock = true;
                }
            }
            [.., "Dc", "OpMode"] => self.mode = Pulses { activate: 0, ..Pulses::default() },
            [.., "Device", "RxPdo" | "TxPdo"] => {
                let is_assigned = attribute("Sm").is_some();
                self.pdo = Some((Pdo { index: 0, entries: Vec::new() }, is_assigned));
            }
            [.., "RxPdo" | "TxPdo", "Entry"] => self.entry = EntryText::default(),
            _ => {}
        }
        Ok(())
    }

    fn end(&mut self) -> std::result::Result<(), String> {
        let text = std::mem::take(&mut self.text).trim().to_string();
        let path: Vec<String> = self.path.clone();
        let at: Vec<&str> = path.iter().map(String::as_str).collect();
        match at[..] {
            [.., "Devices", "Device"] => {
                if let Some(device) = self.devices.last_mut() {
                    device.clock = device.clock.filter(|clock| *clock != Pulses::default());
                }
            }
            ["EtherCATInfo", "Vendor", "Id"] => self.vendor = number(&text)?,
            // The name in the first language; the type's own where there is none.
            [.., "Device", "Type" | "Name"] => {
                if let Some(device) = self.devices.last_mut().filter(|device| device.name.is_empty()) {
                    device.name = text;
                }
            }
            [.., "OpMode", "AssignActivate"] => {
                self.mode.activate =
                    u16::try_from(number(&text)?).map_err(|_| format!("has an AssignActivate {text}"))?;
            }
            [.., "OpMode", "ShiftTimeSync0"] => {
                let shift_ns = text.strip_prefix('-').map_or_else(|| time_ns(&text), |text| Ok(-time_ns(text)?));
                self.mode.sync0_shift_ns = shift_ns?;
            }
            [.., "OpMode", "CycleTimeSync1"] => self.mode.sync1_ns = time_ns(&text)?.unsigned_abs(),
            [.., "Dc", "OpMode"] => self.pulses(),
            [.., "Device", "RxPdo" | "TxPdo", "Index"] => {
                let index = u16::try_from(number(&text)?).map_err(|_| format!("has a PDO {text}"))?;
                if let Some((pdo, _)) = &mut self.pdo {
                    pdo.index = index;
                }
            }
            [.., "Entry", "Index"] => self.entry.index = number(&text)?,
            [.., "Entry", "SubIndex"] => self.entry.sub = number(&text)?,
            [.., "Entry", "BitLen"] => self.entry.bits = number(&text)?,
            [.., "Entry", "DataType"] => self.entry.kind = text,
            [.., "RxPdo" | "TxPdo", "Entry"] => {
                let entry = self.entry.entry()?;
                if let Some((pdo, _)) = &mut self.pdo {
                    pdo.entries.push(entry);
                }
            }
            [.., "Device", direction @ ("RxPdo" | "TxPdo")] => {
                let assigned = self.pdo.take().filter(|(_, is_assigned)| *is_assigned);
                if let (Some((pdo, _)), Some(device)) = (assigned, self.devices.last_mut()) {
                    let data = if direction == "RxPdo" { &mut device.outputs } else { &mut device.inputs };
                    data.pdos.push(pdo);
                }
            }
            _ => {}
        }
        self.path.pop();
        Ok(())
    }
}

impl Open {
    /// The clock's mode that ends is the device's where it pulses and none before did; pulses with every cycle need not be told.
    fn pulses(&mut self) {
        let mode = self.mode;
        if let Some(device) = self.devices.last_mut().filter(|device| device.clock.is_none() && mode.activate != 0) {
            device.clock = Some(mode);
        }
    }
}

impl EntryText {
    /// As the rig has it; its kind by the type that the file tells, else by the object.
    fn entry(&self) -> std::result::Result<Entry, String> {
        let fits = self.index <= 0xFFFF && self.sub <= 0xFF && (1..=255).contains(&self.bits);
        if !fits {
            let Self { index, sub, bits, .. } = self;
            return Err(format!("has an entry {index:#x}:{sub:#x} of {bits} bit"));
        }
        let guessed = entry(self.index << 16 | self.sub << 8 | self.bits);
        let bits = self.bits as u8;
        let kind = match (self.kind.as_str(), bits) {
            ("SINT" | "INT" | "DINT", 8 | 16 | 32) => Kind::Signed(bits),
            ("USINT" | "UINT" | "UDINT" | "BYTE" | "WORD" | "DWORD", 8 | 16 | 32) => Kind::Unsigned(bits),
            ("REAL", 32) => Kind::Real,
            _ => guessed.kind,
        };
        Ok(Entry { kind, ..guessed })
    }
}

/// A time of a clock's mode, ns; none where the element is empty.
fn time_ns(text: &str) -> std::result::Result<i32, String> {
    let ns = if text.is_empty() { 0 } else { number(text)? };
    i32::try_from(ns).map_err(|_| format!("has a time of {text} ns"))
}

/// A number as ESI files write it: `#x1A00` or decimal; some have `0x1A00`.
fn number(text: &str) -> std::result::Result<u32, String> {
    let text = text.trim();
    let found = match ["#x", "#X", "0x"].iter().find_map(|prefix| text.strip_prefix(prefix)) {
        Some(hex) => u32::from_str_radix(hex, 16),
        None => text.parse(),
    };
    found.map_err(|_| format!("has `{text}` where a number should be, such as #x1A00"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::rig::starting_rig;

    const DRIVE: &str = r##"<?xml version="1.0"?>
<EtherCATInfo Version="1.6">
  <Vendor><Id>#x000000AB</Id><Name>A maker</Name></Vendor>
  <Descriptions><Devices>
    <Device Physics="YY">
      <Type ProductCode="#x00000402" RevisionNo="#x00010000">DRV-1</Type>
      <Name LcId="1033"><![CDATA[A drive]]></Name>
      <RxPdo Fixed="0" Sm="2">
        <Index>#x1600</Index><Name>Outputs</Name>
        <Entry><Index>#x6040</Index><SubIndex>0</SubIndex><BitLen>16</BitLen><Name>Control</Name><DataType>UINT</DataType></Entry>
        <Entry><Index>#x607A</Index><SubIndex>#x00</SubIndex><BitLen>32</BitLen><DataType>DINT</DataType></Entry>
      </RxPdo>
      <RxPdo><Index>#x1601</Index><Entry><Index>#x60FF</Index><SubIndex>0</SubIndex><BitLen>32</BitLen></Entry></RxPdo>
      <TxPdo Sm="3">
        <Index>#x1A00</Index>
        <Entry><Index>#x6041</Index><SubIndex>0</SubIndex><BitLen>16</BitLen></Entry>
        <Entry><Index>#x0</Index><BitLen>8</BitLen></Entry>
        <Entry><Index>#x6064</Index><SubIndex>0</SubIndex><BitLen>32</BitLen></Entry>
        <Entry><Index>#x6077</Index><SubIndex>0</SubIndex><BitLen>16</BitLen></Entry>
        <Entry><Index>#x2100</Index><SubIndex>3</SubIndex><BitLen>32</BitLen><DataType>REAL</DataType></Entry>
      </TxPdo>
      <Dc><OpMode><Name>DC</Name><AssignActivate>#x300</AssignActivate></OpMode></Dc>
    </Device>
  </Devices></Descriptions>
</EtherCATInfo>"##;

    #[test]
    fn a_drive_becomes_a_rig_to_fill_in() {
        let found = parse(DRIVE).unwrap();
        let [drive] = &found[..] else { panic!("{found:?}") };
        assert_eq!((drive.vendor, drive.product, drive.revision, drive.has_clock), (0xAB, 0x402, 0x10000, true));
        assert_eq!((drive.outputs.assignment(), drive.inputs.bytes()), (vec![0x1600], 13));
        assert_eq!(drive.inputs.entries().last().map(|entry| entry.kind), Some(Kind::Real));
        let text = starting_rig("eth1", &found).unwrap();
        assert!(text.contains("vendor = 0x000000ab") && text.contains("as = \"target_position\""), "{text}");
    }

    /// Another maker's way of writing: its own encoding and prefix, decimal numbers, references, a modular device, empty times.
    #[test]
    fn another_makers_file_is_read_too() {
        const TERMINAL: &str = r##"<?xml version='1.0' encoding='ISO-8859-1'?>
<!-- written by hand -->
<e:EtherCATInfo xmlns:e="urn:any">
  <e:Vendor><e:Id>4660</e:Id><e:Name LcId="1031">M@ller</e:Name></e:Vendor>
  <e:Descriptions>
    <e:Modules><e:Module><e:Type ModuleIdent="1"/><e:TxPdo Sm="3"><e:Index>#x1A80</e:Index></e:TxPdo></e:Module></e:Modules>
    <e:Devices>
      <e:Device Physics="YK">
        <e:Type CheckRevisionNo="EQ_OR_G" RevisionNo="0x10" ProductCode="#X00FF">Kr@fte &amp; Weg&#32;1</e:Type>
        <e:TxPdo Mandatory="1" Fixed="1" Sm="3">
          <e:Index DependOnSlot="0">6656</e:Index>
          <e:Entry><e:Index>24576</e:Index><e:SubIndex>17</e:SubIndex><e:BitLen>16</e:BitLen><e:DataType>INT</e:DataType></e:Entry>
          <e:Entry><e:Index>#x6000</e:Index><e:SubIndex>1</e:SubIndex><e:BitLen>1</e:BitLen><e:DataType>BOOL</e:DataType></e:Entry>
          <e:Entry><e:Index>0</e:Index><e:BitLen>15</e:BitLen></e:Entry>
          <e:Exclude>#x1A01</e:Exclude>
        </e:TxPdo>
        <e:Dc>
          <e:OpMode><e:Name>FreeRun</e:Name><e:AssignActivate>0</e:AssignActivate><e:ShiftTimeSync0/></e:OpMode>
          <e:OpMode><e:AssignActivate>#x730</e:AssignActivate><e:CycleTimeSync0 Factor="1">0</e:CycleTimeSync0>
            <e:ShiftTimeSync0> -#x10 </e:ShiftTimeSync0><e:CycleTimeSync1></e:CycleTimeSync1></e:OpMode>
        </e:Dc>
      </e:Device>
    </e:Devices>
  </e:Descriptions>
</e:EtherCATInfo>"##;
        let written = TERMINAL.replace('@', "\u{e4}");
        let latin: Vec<u8> = written.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
        // The same with a byte order mark, in UTF-16, whatever it declares.
        let wide: Vec<u8> = std::iter::once(0xFEFF).chain(written.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        let folder = tempfile::TempDir::new().unwrap();
        for bytes in [latin, wide] {
            let file = folder.path().join("maker.xml");
            std::fs::write(&file, &bytes).unwrap();
            let found = read(&file).unwrap();
            let [terminal] = &found[..] else { panic!("{found:?}") };
            assert_eq!((terminal.vendor, terminal.product, terminal.revision), (0x1234, 0xFF, 0x10));
            assert_eq!((terminal.name.as_str(), terminal.has_clock), ("Kr\u{e4}fte & Weg 1", true));
            assert_eq!((terminal.inputs.assignment(), terminal.inputs.bytes()), (vec![0x1A00], 4));
            assert_eq!(terminal.clock, Some(Pulses { activate: 0x730, sync0_shift_ns: -16, sync1_ns: 0 }));
        }
    }

    #[test]
    fn the_clock_pulses_as_the_maker_has_it() {
        let clock = |modes: &str| {
            let (before, _) = DRIVE.split_once("<OpMode>").unwrap();
            let (_, after) = DRIVE.split_once("</OpMode>").unwrap();
            let found = parse(&format!("{before}{modes}{after}")).unwrap();
            let text = starting_rig("eth1", &found).unwrap();
            (found[0].clock, text.lines().find(|line| line.starts_with("clock =")).map(str::to_string))
        };
        let mode = |activate: &str, more: &str| {
            format!("<OpMode><Name>M</Name><AssignActivate>{activate}</AssignActivate>{more}</OpMode>")
        };
        assert_eq!(clock(&mode("#x0300", "")), (None, None));
        let free = mode("#x0", "");
        let shifted = mode("#x0700", "<ShiftTimeSync0>-5000</ShiftTimeSync0><CycleTimeSync1>250000</CycleTimeSync1>");
        let (found, line) = clock(&format!("{free}{shifted}{}", mode("#x0300", "")));
        assert_eq!(found, Some(Pulses { activate: 0x700, sync0_shift_ns: -5000, sync1_ns: 250_000 }));
        assert_eq!(
            line.as_deref(),
            Some("clock = { assign_activate = 0x0700, sync0_shift_us = -5.0, sync1_us = 250.0 }")
        );
        assert_eq!(clock(&format!("{}{shifted}", mode("#x0300", ""))), (None, None));
    }

    #[test]
    fn what_is_wrong_is_told_by_its_row() {
        assert_eq!(parse("<robot/>").unwrap_err().0, 1);
        let (row, what) = parse(&DRIVE.replace("#x607A", "607A")).unwrap_err();
        assert_eq!((row, what.contains("`607A`")), (11, true), "{what}");
        assert!(parse(&DRIVE.replace("<BitLen>8<", "<BitLen>0<")).unwrap_err().1.contains("of 0 bit"));
        assert!(parse("<EtherCATInfo><a></b>").is_err());
    }
}
