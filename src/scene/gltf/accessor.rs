//! Typed reading of accessors: every component type, normalised integers, strides and sparse substitution.

use std::borrow::Cow;

use gltf::json::{
    Index, Root,
    accessor::{ComponentType, Type, sparse::Sparse},
};

use super::buffers::Buffers;
use crate::scene::Problem;

/// Bytes that an accessor without a buffer view may expand to in a small file.
const ZERO_FILL_FLOOR: usize = 1 << 20;

/// Elements `0..count`, all inside `data`.
pub(super) struct Accessor<'a> {
    data: Cow<'a, [u8]>,
    stride: usize,
    pub count: usize,
    component: ComponentType,
    pub components: usize,
    normalized: bool,
}

impl<'a> Accessor<'a> {
    /// Fails where the accessor's elements are not all inside its buffer view.
    pub fn new(root: &Root, buffers: &'a Buffers, index: Index<gltf::json::Accessor>) -> Result<Self, Problem> {
        let json = &root.accessors[index.value()];
        let invalid = |what: String| Problem::invalid(format!("accessors[{}]", index.value()), what);
        let component = json.component_type.as_ref().unwrap().0;
        let components = json.type_.as_ref().unwrap().multiplicity();
        let size = component.size() * components;
        let count = usize::try_from(json.count.0).map_err(|_| invalid(format!("claims {} elements", json.count.0)))?;
        let (data, stride) = match json.buffer_view {
            Some(view) => {
                let stride = root.buffer_views[view.value()].byte_stride.map_or(size, |stride| stride.0);
                let offset = json.byte_offset.unwrap_or_default().0;
                let elements = elements(buffers.view(root, view)?, offset, count, size, stride).map_err(&invalid)?;
                (Cow::Borrowed(elements), stride)
            }
            None => (Cow::Owned(zeros(count, size, buffers.total).map_err(&invalid)?), size),
        };
        let mut accessor = Self { data, stride, count, component, components, normalized: json.normalized };
        if let Some(sparse) = &json.sparse {
            accessor.substitute(root, buffers, sparse, size).map_err(|problem| match problem {
                Problem::Invalid { what, .. } => invalid(format!("sparse: {what}")),
                other => other,
            })?;
        }
        Ok(accessor)
    }

    /// Replaces the elements that `sparse` lists, in a packed copy.
    fn substitute(&mut self, root: &Root, buffers: &Buffers, sparse: &Sparse, size: usize) -> Result<(), Problem> {
        let invalid = |what: String| Problem::invalid("sparse", what);
        let count = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        let component = sparse.indices.component_type.as_ref().unwrap().0;
        let index_bytes = buffers.view(root, sparse.indices.buffer_view)?;
        let indices = elements(index_bytes, sparse.indices.byte_offset.0, count, component.size(), component.size()).map_err(invalid)?;
        let value_bytes = buffers.view(root, sparse.values.buffer_view)?;
        let values = elements(value_bytes, sparse.values.byte_offset.0, count, size, size).map_err(invalid)?;
        let mut packed: Vec<u8> = (0..self.count).flat_map(|i| &self.data[i * self.stride..i * self.stride + size]).copied().collect();
        for (index, value) in indices.chunks_exact(component.size()).zip(values.chunks_exact(size)) {
            let start = unsigned(component, index) as usize * size;
            packed
                .get_mut(start..start + size)
                .ok_or_else(|| invalid(format!("substitutes element {} of {}", start / size, self.count)))?
                .copy_from_slice(value);
        }
        (self.data, self.stride) = (Cow::Owned(packed), size);
        Ok(())
    }

    /// The first `N` components of element `index`, integers normalised where the accessor says so.
    /// Components that it does not have are 1, as the alpha of a colour.
    pub fn vector<const N: usize>(&self, index: usize) -> [f32; N] {
        let element = &self.data[index * self.stride..];
        let size = self.component.size();
        std::array::from_fn(|i| if i < self.components { self.scalar(&element[i * size..]) } else { 1.0 })
    }

    /// Element `index` of unsigned integers.
    pub fn index(&self, index: usize) -> u32 {
        unsigned(self.component, &self.data[index * self.stride..])
    }

    pub fn is_index(&self) -> bool {
        self.components == 1 && matches!(self.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
    }

    fn scalar(&self, bytes: &[u8]) -> f32 {
        let (value, largest) = match self.component {
            ComponentType::I8 => (f32::from(bytes[0] as i8), 127.0),
            ComponentType::U8 => (f32::from(bytes[0]), 255.0),
            ComponentType::I16 => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
            ComponentType::U16 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
            ComponentType::U32 => (unsigned(self.component, bytes) as f32, u32::MAX as f32),
            ComponentType::F32 => return f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        };
        if self.normalized { (value / largest).max(-1.0) } else { value }
    }
}

fn unsigned(component: ComponentType, bytes: &[u8]) -> u32 {
    match component {
        ComponentType::U8 => u32::from(bytes[0]),
        ComponentType::U16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    }
}

/// `count` elements of `size` bytes, `stride` apart, from `offset` on; the last may end before its stride does.
fn elements(view: &[u8], offset: u64, count: usize, size: usize, stride: usize) -> Result<&[u8], String> {
    if stride < size {
        return Err(format!("its elements of {size} bytes overlap at a stride of {stride}"));
    }
    let length = match count {
        0 => Some(0),
        _ => (count - 1).checked_mul(stride).and_then(|length| length.checked_add(size)),
    };
    usize::try_from(offset)
        .ok()
        .and_then(|offset| view.get(offset..)?.get(..length?))
        .ok_or_else(|| format!("claims {count} elements of {size} bytes at offset {offset}, but its buffer view has {} bytes", view.len()))
}

/// Without a buffer view all elements are zero; a file cannot claim more of them than it has bytes.
fn zeros(count: usize, size: usize, bytes_in_file: usize) -> Result<Vec<u8>, String> {
    match count.checked_mul(size) {
        Some(length) if length <= bytes_in_file.max(ZERO_FILL_FLOOR) => Ok(vec![0; length]),
        _ => Err(format!("claims {count} elements without a buffer view, more than the whole file has bytes")),
    }
}

/// What a use of an accessor asks of its type: (accessor type, may be integers).
pub(super) fn check_type(root: &Root, index: Index<gltf::json::Accessor>, allowed: &[Type], usage: &str) -> Result<(), Problem> {
    let kind = *root.accessors[index.value()].type_.as_ref().unwrap();
    if allowed.contains(&kind) {
        return Ok(());
    }
    Err(Problem::invalid(format!("accessors[{}]", index.value()), format!("{usage} must be of type {allowed:?}, not {kind:?}")))
}
