//! One pass: what it declares, held against what its shader says, and what follows from it.

use super::graph::FrameBuilder;
use super::resources::{BufferHandle, Resource, Resources};
use crate::gpu::{ComputePipeline, DescriptorSet, GpuError, traces_rays};
use shader_compiler::{Binding, BindingKind};
use std::ffi::CString;
use std::sync::Arc;

/// A pass that is ready to be recorded.
pub(super) struct Pass {
    pub name: &'static str,
    pub label: CString,
    pub work: Work,
    /// It touches what an earlier pass of the frame has written, or writes what one has read.
    pub barrier: bool,
    pub traffic: Traffic,
}

pub(super) enum Work {
    Dispatch {
        pipeline: Arc<ComputePipeline>,
        /// One, or one for each parity where the pass touches a history.
        sets: Vec<DescriptorSet>,
        /// The kernel's push constant, where it has one.
        argument: u32,
        groups: Groups,
    },
    Fill {
        buffer: BufferHandle,
        word: u32,
    },
    /// The passes from `first` up to this one, for each sample per pixel after the first.
    Repeat {
        first: usize,
    },
}

/// Workgroups of a dispatch.
#[derive(Debug, Clone, Copy)]
pub(super) enum Groups {
    Fixed([u32; 3]),
    /// Three words of a buffer, so many bytes from its start.
    Indirect(BufferHandle, u64),
}

/// What a pass asks of the device: bytes by its declaration, each value of each image and buffer once, unless it declares fewer.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traffic {
    pub read: u64,
    pub written: u64,
    /// Its kernel traces rays.
    pub traces: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Access {
    Read,
    Write,
    Update,
}

/// What a pass does with a resource.
#[derive(Debug, Clone, Copy)]
pub(super) struct Use {
    pub variable: &'static str,
    pub resource: Resource,
    pub access: Access,
    /// Bytes that it touches.
    pub bytes: u64,
}

impl std::ops::AddAssign for Traffic {
    fn add_assign(&mut self, other: Self) {
        self.read += other.read;
        self.written += other.written;
        self.traces |= other.traces;
    }
}

impl Traffic {
    pub(super) fn of(uses: &[Use]) -> Self {
        uses.iter().fold(Self::default(), |sum, one| {
            let counted = |counts: bool| if counts { one.bytes } else { 0 };
            Self {
                read: sum.read + counted(one.access != Access::Write),
                written: sum.written + counted(one.access != Access::Read),
                ..sum
            }
        })
    }
}

/// One pass under construction; each use names the shader's variable.
pub struct PassBuilder<'b, 'a> {
    frame: &'b mut FrameBuilder<'a>,
    name: &'static str,
    shader: &'static str,
    uses: Vec<Use>,
    constants: Vec<(u32, u32)>,
    argument: Option<u32>,
    extent: Extent,
}

/// How many invocations.
enum Extent {
    Pixels,
    Elements(u32),
    Groups(u32),
    Indirect(BufferHandle, u64),
}

/// Most workgroups along an axis that every device takes.
pub const MOST_GROUPS: u32 = 65_535;

impl<'b, 'a> PassBuilder<'b, 'a> {
    pub(super) fn new(frame: &'b mut FrameBuilder<'a>, name: &'static str, shader: &'static str, constants: Vec<(u32, u32)>) -> Self {
        Self { frame, name, shader, uses: Vec::new(), constants, argument: None, extent: Extent::Pixels }
    }

    pub fn reads(self, variable: &'static str, resource: impl Into<Resource>) -> Self {
        self.uses(variable, resource.into(), Access::Read)
    }

    pub fn writes(self, variable: &'static str, resource: impl Into<Resource>) -> Self {
        self.uses(variable, resource.into(), Access::Write)
    }

    /// Reads and writes: an image's pixel by its own invocation only, a buffer's elements by such, or atomically.
    pub fn updates(self, variable: &'static str, resource: impl Into<Resource>) -> Self {
        self.uses(variable, resource.into(), Access::Update)
    }

    fn uses(mut self, variable: &'static str, resource: Resource, access: Access) -> Self {
        let bytes = self.frame.resources.byte_size(resource);
        self.uses.push(Use { variable, resource, access, bytes });
        self
    }

    /// The use declared last touches so many bytes, not the whole of its resource.
    ///
    /// # Panics
    /// Where nothing has been declared.
    pub fn touching(mut self, bytes: u64) -> Self {
        self.uses.last_mut().expect("follows a use").bytes = bytes;
        self
    }

    /// A specialization constant of this pass's own.
    pub fn constant(mut self, id: u32, value: u32) -> Self {
        self.constants.push((id, value));
        self
    }

    /// The kernel's push constant, one word: what sets passes of one kernel apart that share a pipeline.
    pub fn argument(mut self, word: u32) -> Self {
        self.argument = Some(word);
        self
    }

    /// As many workgroups as three words of a buffer say, `offset` bytes from its start, that earlier passes of the frame have written.
    pub fn indirect(mut self, groups: BufferHandle, offset: u64) -> Self {
        self.extent = Extent::Indirect(groups, offset);
        self
    }

    /// So many workgroups instead of one invocation per pixel.
    pub fn groups(mut self, count: u32) -> Self {
        self.extent = Extent::Groups(count);
        self
    }

    /// One invocation per element instead of one per pixel, in workgroups of one dimension: `element_index` of lib/elements.glsl numbers
    /// them, and exceeds `count` in the last ones.
    pub fn elements(mut self, count: u32) -> Self {
        self.extent = Extent::Elements(count);
        self
    }

    /// # Errors
    /// The declaration differs from the shader's: a variable without a resource, a resource without a variable, other access. A
    /// specialization constant has two values.
    pub fn add(self) -> Result<(), GpuError> {
        let frame = self.frame;
        let wrong = |message| GpuError::Interface { shader: self.shader.to_owned(), message };
        check_constants(&self.constants).map_err(wrong)?;
        let pipeline = frame.pipeline(self.shader, &self.constants)?;
        check_argument(self.argument, pipeline.reflection().push_constant_size).map_err(wrong)?;
        let bindings: Vec<&Binding> = pipeline.reflection().bindings.iter().filter(|b| b.set == 1).collect();
        check(&bindings, &self.uses).and_then(|()| check_formats(&bindings, &self.uses, &frame.resources)).map_err(wrong)?;
        let alternates = self.uses.iter().any(|one| frame.resources.alternates(one.resource));
        let set = |parity| descriptor_set(&pipeline, &bindings, &self.uses, &frame.resources, parity);
        let sets = (0..1 + usize::from(alternates)).map(set).collect::<Result<_, _>>()?;
        let groups = match self.extent {
            Extent::Pixels => Groups::Fixed(pipeline.groups([frame.extent[0], frame.extent[1], 1])),
            Extent::Elements(count) => Groups::Fixed(rows_of_groups(pipeline.groups([count, 1, 1])[0])),
            Extent::Groups(count) => Groups::Fixed([count, 1, 1]),
            Extent::Indirect(buffer, offset) => Groups::Indirect(buffer, offset),
        };
        let mut uses = self.uses;
        if let Groups::Indirect(buffer, _) = groups {
            uses.push(Use { variable: "", resource: buffer.into(), access: Access::Read, bytes: INDIRECT_BYTES });
        }
        let traffic = Traffic { traces: traces_rays(self.shader), ..Traffic::of(&uses) };
        frame.push(self.name, Work::Dispatch { pipeline, sets, argument: self.argument.unwrap_or(0), groups }, traffic, &uses);
        Ok(())
    }
}

/// Three words.
const INDIRECT_BYTES: u64 = 12;

/// The pass's push constant against the size in bytes of the kernel's.
fn check_argument(argument: Option<u32>, size: u32) -> Result<(), String> {
    let given = if argument.is_some() { 4 } else { 0 };
    if given == size { Ok(()) } else { Err(format!("it takes {size} bytes of push constants, and the pass gives it {given}")) }
}

/// At least so many workgroups, in rows that every device takes.
fn rows_of_groups(count: u32) -> [u32; 3] {
    let rows = count.div_ceil(MOST_GROUPS).max(1);
    [count.div_ceil(rows), rows, 1]
}

fn descriptor_set(
    pipeline: &ComputePipeline,
    bindings: &[&Binding],
    uses: &[Use],
    resources: &Resources,
    parity: usize,
) -> Result<DescriptorSet, GpuError> {
    let set = DescriptorSet::new(pipeline.own_layout())?;
    for binding in bindings {
        let one = uses.iter().find(|one| one.variable == binding.name).expect("checked");
        match one.resource {
            Resource::Image(handle) => set.write_storage_image(binding.binding, resources.image_of(handle, parity)),
            Resource::Buffer(handle) => {
                let buffer = resources.buffer_of(handle, parity);
                set.write_buffer(binding.binding, buffer, buffer.size());
            }
        }
    }
    Ok(set)
}

/// The shader's variables against what the pass declares.
fn check(bindings: &[&Binding], uses: &[Use]) -> Result<(), String> {
    for binding in bindings {
        let Some(one) = uses.iter().find(|one| one.variable == binding.name) else {
            return Err(format!("the pass declares nothing for '{}'", binding.name));
        };
        let kind = match one.resource {
            Resource::Image(_) => BindingKind::StorageImage,
            Resource::Buffer(_) => BindingKind::StorageBuffer,
        };
        let declared = (one.access != Access::Write, one.access != Access::Read);
        if binding.kind != kind || (binding.readable, binding.writable) != declared {
            return Err(format!("'{}' is declared for another use: {:?}", binding.name, one.access));
        }
    }
    match uses.iter().find(|one| !bindings.iter().any(|b| b.name == one.variable)) {
        Some(one) => Err(format!("it has no '{}'", one.variable)),
        None => Ok(()),
    }
}

/// Of images: the qualifier in the shader has to be the image's own.
fn check_formats(bindings: &[&Binding], uses: &[Use], resources: &Resources) -> Result<(), String> {
    for one in uses {
        let Resource::Image(handle) = one.resource else { continue };
        let qualifier = resources.image_of(handle, 0).format_qualifier();
        if let Some(binding) = bindings.iter().find(|binding| binding.name == one.variable && binding.format != qualifier) {
            return Err(format!("'{}' is declared {}, its image is {qualifier}", binding.name, binding.format));
        }
    }
    Ok(())
}

/// Where two constants share an id, which of them a kernel sees would be chance.
fn check_constants(constants: &[(u32, u32)]) -> Result<(), String> {
    let mut ids = std::collections::HashSet::new();
    match constants.iter().find(|(id, _)| !ids.insert(*id)) {
        Some((id, _)) => Err(format!("two specialization constants have the id {id}")),
        None => Ok(()),
    }
}

/// What a frame's passes have touched since the last barrier.
#[derive(Default)]
pub(super) struct Hazards {
    read: std::collections::HashSet<Resource>,
    written: std::collections::HashSet<Resource>,
}

impl Hazards {
    /// Whether a pass with these uses must wait for the ones before it.
    pub fn needs_barrier(&mut self, uses: &[Use]) -> bool {
        let conflicts =
            |one: &Use| self.written.contains(&one.resource) || (one.access != Access::Read && self.read.contains(&one.resource));
        let barrier = uses.iter().any(conflicts);
        if barrier {
            self.read.clear();
            self.written.clear();
        }
        for one in uses {
            let touched = if one.access == Access::Read { &mut self.read } else { &mut self.written };
            touched.insert(one.resource);
        }
        barrier
    }
}

/// Names of passes have no zeros.
pub(super) fn label(name: &'static str) -> CString {
    CString::new(name).expect("pass names have no zeros")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pass_waits_for_what_it_reads_and_for_readers_of_what_it_writes() {
        let mut handles = Resources::default();
        let [a, b] = [0, 1].map(|_| handles.placeholder());
        let touch = |resource, access| Use { variable: "", resource, access, bytes: 4 };
        let mut hazards = Hazards::default();
        assert!(!hazards.needs_barrier(&[touch(a, Access::Write)]));
        assert!(!hazards.needs_barrier(&[touch(b, Access::Write)]), "nothing in common");
        assert!(hazards.needs_barrier(&[touch(a, Access::Read)]), "read after write");
        assert!(!hazards.needs_barrier(&[touch(a, Access::Read), touch(b, Access::Read)]), "reads after the barrier");
        assert!(hazards.needs_barrier(&[touch(b, Access::Update)]), "write after read");
        assert!(hazards.needs_barrier(&[touch(b, Access::Write)]), "write after write");
    }

    #[test]
    fn an_id_stands_for_one_constant() {
        assert!(check_constants(&[(1, 0), (2, 0)]).is_ok());
        assert!(check_constants(&[(1, 0), (2, 0), (1, 0)]).unwrap_err().contains("id 1"));
    }

    #[test]
    fn a_pass_gives_the_word_that_its_kernel_takes() {
        assert!(check_argument(None, 0).is_ok() && check_argument(Some(7), 4).is_ok());
        assert!(check_argument(Some(7), 0).is_err() && check_argument(None, 4).is_err() && check_argument(Some(7), 8).is_err());
    }

    #[test]
    fn traffic_is_what_each_use_declares() {
        let resource = Resources::default().placeholder();
        let touch = |access, bytes| Use { variable: "", resource, access, bytes };
        let traffic = Traffic::of(&[touch(Access::Read, 1), touch(Access::Write, 10), touch(Access::Update, 100)]);
        assert_eq!(traffic, Traffic { read: 101, written: 110, traces: false });
    }

    #[test]
    fn elements_are_covered_by_rows_that_every_device_takes() {
        for count in [1, 65_535, 65_536, 1 << 24] {
            let [x, y, _] = rows_of_groups(count);
            assert!(x <= MOST_GROUPS && y <= MOST_GROUPS && u64::from(x) * u64::from(y) >= u64::from(count));
        }
        assert_eq!(rows_of_groups(7), [7, 1, 1]);
    }
}
