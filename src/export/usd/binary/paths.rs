//! The tree of paths of a crate file.

use super::tables::Tables;
use std::collections::HashMap;

/// Paths by number; number 0 is the root.
pub(super) struct Paths {
    nodes: Vec<Node>,
    known: HashMap<(u32, i32), u32>,
}

struct Node {
    /// Token of the last element; negative for a property.
    element: i32,
    children: Vec<u32>,
}

/// The three lists that a file holds: number of the path, its element, where to go next.
#[derive(Default)]
pub(super) struct Encoded {
    pub(super) paths: Vec<i32>,
    pub(super) elements: Vec<i32>,
    pub(super) jumps: Vec<i32>,
}

impl Paths {
    /// Number of the root.
    pub(super) const ROOT: u32 = 0;

    pub(super) fn new() -> Self {
        Self {
            nodes: vec![Node {
                element: 0,
                children: Vec::new(),
            }],
            known: HashMap::new(),
        }
    }

    /// Number of paths.
    pub(super) fn count(&self) -> usize {
        self.nodes.len()
    }

    /// A prim below another, or a variant: `{set=name}`.
    pub(super) fn prim(&mut self, parent: u32, element: &str, tables: &mut Tables) -> u32 {
        let token = tables.token(element) as i32;
        self.child(parent, token)
    }

    /// A property of a prim.
    pub(super) fn property(&mut self, parent: u32, name: &str, tables: &mut Tables) -> u32 {
        let token = tables.token(name) as i32;
        self.child(parent, -token)
    }

    /// An absolute path such as `/a/b` or `/a/b.outputs:out`.
    pub(super) fn absolute(&mut self, path: &str, tables: &mut Tables) -> u32 {
        let (prims, property) = match path.split_once('.') {
            Some((prims, property)) => (prims, Some(property)),
            None => (path, None),
        };
        let mut node = Self::ROOT;
        for name in prims.split('/').filter(|name| !name.is_empty()) {
            node = self.prim(node, name, tables);
        }
        match property {
            Some(property) => self.property(node, property, tables),
            None => node,
        }
    }

    fn child(&mut self, parent: u32, element: i32) -> u32 {
        if let Some(&known) = self.known.get(&(parent, element)) {
            return known;
        }
        let index = self.nodes.len() as u32;
        self.nodes.push(Node {
            element,
            children: Vec::new(),
        });
        self.nodes[parent as usize].children.push(index);
        self.known.insert((parent, element), index);
        index
    }

    /// Parents before children. A jump is -2 for a leaf, -1 if only a child follows, 0 if only the next
    /// sibling does, or the distance to the next sibling behind the children.
    pub(super) fn encode(&self) -> Encoded {
        let mut out = Encoded::default();
        self.visit(Self::ROOT, false, &mut out);
        out
    }

    fn visit(&self, index: u32, has_sibling: bool, out: &mut Encoded) {
        let node = &self.nodes[index as usize];
        let place = out.jumps.len();
        out.paths.push(index as i32);
        out.elements.push(node.element);
        out.jumps
            .push(match (node.children.is_empty(), has_sibling) {
                (true, false) => -2,
                (false, false) => -1,
                (true, true) => 0,
                (false, true) => 0, // Known once the children are written.
            });
        for (i, &child) in node.children.iter().enumerate() {
            self.visit(child, i + 1 < node.children.len(), out);
        }
        if has_sibling && !node.children.is_empty() {
            out.jumps[place] = (out.jumps.len() - place) as i32;
        }
    }
}
