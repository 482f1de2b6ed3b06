//! XML as a tree of elements with their attributes; texts between them are ignored.

use crate::document::bytes;
use crate::limits::{URDF_BYTES, URDF_DEPTH, URDF_ELEMENTS};
use crate::problem::{Problem, Result};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::path::Path;

/// One element.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Node {
    pub name: String,
    pub attributes: BTreeMap<String, String>,
    pub children: Vec<Node>,
}

impl Node {
    /// The attribute `key`.
    pub fn text(&self, key: &str) -> Option<&str> {
        self.attributes.get(key).map(String::as_str)
    }

    /// The numbers of the attribute `key`; `None` where it is absent or holds something else.
    pub fn numbers(&self, key: &str) -> Option<Vec<f64>> {
        self.text(key)?.split_whitespace().map(|word| word.parse().ok().filter(|x: &f64| x.is_finite())).collect()
    }

    /// The children called `name`.
    pub fn all<'n>(&'n self, name: &'n str) -> impl Iterator<Item = &'n Self> {
        self.children.iter().filter(move |child| child.name == name)
    }
}

/// The outermost element of `file`.
///
/// Errors: it cannot be read, is no XML, or has more elements, or deeper ones, than any robot.
pub(super) fn read(file: &Path) -> Result<Node> {
    let text = String::from_utf8_lossy(&bytes(file, URDF_BYTES)?).into_owned();
    let refuse = |what: String| Problem::error(file, what, "name a URDF or a MuJoCo XML").alone();
    let mut reader = Reader::from_str(&text);
    let mut open = vec![Node::default()];
    let mut elements = 0;
    loop {
        match reader.read_event() {
            Ok(Event::Eof) => break,
            Ok(Event::Start(start)) => {
                elements += 1;
                open.push(node(&start));
            }
            Ok(Event::Empty(start)) => {
                elements += 1;
                let child = node(&start);
                if let Some(parent) = open.last_mut() {
                    parent.children.push(child);
                }
            }
            Ok(Event::End(_)) if open.len() > 1 => {
                let done = open.pop().unwrap_or_default();
                if let Some(parent) = open.last_mut() {
                    parent.children.push(done);
                }
            }
            Ok(Event::DocType(_)) => return refuse("declares a document type, which no robot needs".to_string()),
            Ok(_) => {}
            Err(error) => return refuse(format!("is no XML: {error}")),
        }
        if open.len() > URDF_DEPTH || elements > URDF_ELEMENTS {
            return refuse(format!("has more than {URDF_ELEMENTS} elements, or more than {URDF_DEPTH} in each other"));
        }
    }
    match open.pop().and_then(|outside| outside.children.into_iter().next()) {
        Some(root) if open.is_empty() => Ok(root),
        _ => refuse("holds no whole element".to_string()),
    }
}

/// Included files at most, and in each other.
const INCLUDED: usize = 64;

/// `root` of `file` with what each `<include file>` names in its place, as MuJoCo does it: the children of that file's outermost element.
///
/// Errors: an included file cannot be read; files that include each other without end.
pub(super) fn with_included(root: Node, file: &Path) -> Result<Node> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let mut left = INCLUDED;
    expanded(root, folder, &mut left)
}

fn expanded(node: Node, folder: &Path, left: &mut usize) -> Result<Node> {
    let mut children = Vec::new();
    for child in node.children {
        match child.text("file").filter(|_| child.name == "include") {
            Some(name) => {
                let file = folder.join(name);
                if *left == 0 {
                    let cure = "files that include each other have no end";
                    return Problem::error(file, format!("is included beyond {INCLUDED} others"), cure).alone();
                }
                *left -= 1;
                children.extend(expanded(read(&file)?, folder, left)?.children);
            }
            None => children.push(expanded(child, folder, left)?),
        }
    }
    Ok(Node { children, ..node })
}

fn node(start: &BytesStart<'_>) -> Node {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let pairs = start.attributes().flatten().map(|pair| (text(pair.key.as_ref()), text(&pair.value)));
    Node { name: text(start.name().as_ref()), attributes: pairs.collect(), children: Vec::new() }
}
