//! What a SPIR-V module says about itself.

use rspirv::dr::{Instruction, Module, Operand};
use rspirv::spirv::{Decoration, Dim, Op, StorageClass, Word};
use std::collections::{HashMap, HashSet};

/// How a kernel meets the host.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Reflection {
    /// Resources that the code uses, by set and binding.
    pub bindings: Vec<Binding>,
    /// Bytes; 0 where there are none.
    pub push_constant_size: u32,
    /// Invocations per workgroup.
    pub local_size: [u32; 3],
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Binding {
    pub set: u32,
    pub binding: u32,
    /// Of the variable, or of the block where the variable has none.
    pub name: String,
    pub kind: BindingKind,
    /// Of a storage image, as its declaration has it: `rgba32f`. Empty for everything else.
    pub format: String,
    /// An array without a size.
    pub unbounded: bool,
    /// Neither is restricted where the shader does not say `readonly` or `writeonly`. A buffer is what all its members are.
    pub readable: bool,
    pub writable: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BindingKind {
    UniformBuffer,
    StorageBuffer,
    StorageImage,
    SampledImage,
    /// A buffer read through a format: `usamplerBuffer`.
    TexelBuffer,
    AccelerationStructure,
}

/// Offset in bytes of each member of a struct, by the struct's name, as decorated in the module.
pub type StructOffsets = HashMap<String, Vec<(String, u32)>>;

struct Types<'a> {
    module: &'a Module,
    by_id: HashMap<Word, &'a Instruction>,
    names: HashMap<Word, &'a str>,
}

/// Reads a module that was compiled here; the error says what is unusual about it.
pub fn reflect(spirv: &[u32]) -> Result<Reflection, String> {
    let module = rspirv::dr::load_words(spirv).map_err(|error| error.to_string())?;
    let types = Types::new(&module);
    let used = ids_used_in_functions(&module);
    let mut reflection = Reflection { local_size: local_size(&module), ..Default::default() };
    for variable in module.types_global_values.iter().filter(|i| i.class.opcode == Op::Variable) {
        let id = variable.result_id.expect("a variable has an id");
        let storage = match variable.operands[0] {
            Operand::StorageClass(storage) => storage,
            _ => return Err("a variable without a storage class".to_owned()),
        };
        if !used.contains(&id) {
            continue;
        }
        let pointee = types.pointee(variable)?;
        match storage {
            StorageClass::PushConstant => reflection.push_constant_size = types.struct_size(pointee)?,
            StorageClass::Uniform | StorageClass::UniformConstant | StorageClass::StorageBuffer => {
                reflection.bindings.push(types.binding(id, pointee, storage)?);
            }
            _ => {}
        }
    }
    reflection.bindings.sort_by_key(|b| (b.set, b.binding));
    Ok(reflection)
}

/// Member offsets of every named, laid-out struct.
pub fn struct_offsets(spirv: &[u32]) -> Result<StructOffsets, String> {
    let module = rspirv::dr::load_words(spirv).map_err(|error| error.to_string())?;
    let types = Types::new(&module);
    let mut result = StructOffsets::new();
    for structure in module.types_global_values.iter().filter(|i| i.class.opcode == Op::TypeStruct) {
        let id = structure.result_id.expect("a type has an id");
        let offsets = types.member_offsets(id);
        if offsets.len() == structure.operands.len() {
            let names = types.member_names(id);
            let members = offsets.iter().map(|(index, offset)| (names.get(index).copied().unwrap_or("").to_owned(), *offset)).collect();
            result.insert(types.names.get(&id).copied().unwrap_or("").to_owned(), members);
        }
    }
    Ok(result)
}

impl<'a> Types<'a> {
    fn new(module: &'a Module) -> Self {
        let by_id = module.types_global_values.iter().filter_map(|i| Some((i.result_id?, i))).collect();
        let names = module.debug_names.iter().filter(|i| i.class.opcode == Op::Name).filter_map(name_of).collect();
        Self { module, by_id, names }
    }

    fn pointee(&self, variable: &Instruction) -> Result<&'a Instruction, String> {
        let pointer = self.by_id[&variable.result_type.expect("a variable has a type")];
        let id = pointer.operands[1].id_ref_any().ok_or("a pointer to nothing")?;
        Ok(self.by_id[&id])
    }

    fn binding(&self, variable: Word, pointee: &'a Instruction, storage: StorageClass) -> Result<Binding, String> {
        let (element, unbounded) = match pointee.class.opcode {
            Op::TypeRuntimeArray => (self.by_id[&pointee.operands[0].id_ref_any().expect("element type")], true),
            _ => (pointee, false),
        };
        let kind = match element.class.opcode {
            Op::TypeStruct if storage == StorageClass::StorageBuffer => BindingKind::StorageBuffer,
            Op::TypeStruct => BindingKind::UniformBuffer,
            // Operand 5 is `Sampled`: 2 for images that are read and written without a sampler.
            Op::TypeImage if element.operands[5] == Operand::LiteralBit32(2) => BindingKind::StorageImage,
            Op::TypeSampledImage if self.is_buffer_image(element) => BindingKind::TexelBuffer,
            Op::TypeSampledImage => BindingKind::SampledImage,
            Op::TypeAccelerationStructureKHR => BindingKind::AccelerationStructure,
            other => return Err(format!("a resource of type {other:?} is not supported")),
        };
        let name = [variable, element.result_id.unwrap_or(0)].iter().find_map(|id| self.names.get(id).filter(|n| !n.is_empty()));
        Ok(Binding {
            set: self.decoration(variable, Decoration::DescriptorSet).ok_or("a resource without a set")?,
            binding: self.decoration(variable, Decoration::Binding).ok_or("a resource without a binding")?,
            name: name.copied().unwrap_or("").to_owned(),
            kind,
            format: image_format(element),
            unbounded,
            readable: !self.is_restricted(variable, element, Decoration::NonReadable),
            writable: !self.is_restricted(variable, element, Decoration::NonWritable),
        })
    }

    fn is_buffer_image(&self, sampled: &Instruction) -> bool {
        let image = sampled.operands[0].id_ref_any().map(|id| self.by_id[&id]);
        image.is_some_and(|image| image.operands[1] == Operand::Dim(Dim::DimBuffer))
    }

    fn is_decorated(&self, id: Word, wanted: Decoration) -> bool {
        self.module
            .annotations
            .iter()
            .any(|i| i.class.opcode == Op::Decorate && i.operands == [Operand::IdRef(id), Operand::Decoration(wanted)])
    }

    /// The variable is decorated, or every member of its block.
    fn is_restricted(&self, variable: Word, element: &Instruction, wanted: Decoration) -> bool {
        let Some(block) = element.result_id.filter(|_| element.class.opcode == Op::TypeStruct) else {
            return self.is_decorated(variable, wanted);
        };
        let of_member = |i: &&Instruction| match i.operands.as_slice() {
            [Operand::IdRef(target), Operand::LiteralBit32(_), Operand::Decoration(decoration)] => {
                *target == block && *decoration == wanted
            }
            _ => false,
        };
        let members = self.module.annotations.iter().filter(of_member).count();
        self.is_decorated(variable, wanted) || (members > 0 && members == element.operands.len())
    }

    fn decoration(&self, id: Word, wanted: Decoration) -> Option<u32> {
        self.module.annotations.iter().find_map(|i| match i.operands.as_slice() {
            [Operand::IdRef(target), Operand::Decoration(decoration), Operand::LiteralBit32(value)]
                if i.class.opcode == Op::Decorate && *target == id && *decoration == wanted =>
            {
                Some(*value)
            }
            _ => None,
        })
    }

    fn member_offsets(&self, id: Word) -> Vec<(u32, u32)> {
        let mut offsets: Vec<(u32, u32)> = self
            .module
            .annotations
            .iter()
            .filter_map(|i| match i.operands.as_slice() {
                [
                    Operand::IdRef(target),
                    Operand::LiteralBit32(member),
                    Operand::Decoration(Decoration::Offset),
                    Operand::LiteralBit32(offset),
                ] if *target == id => Some((*member, *offset)),
                _ => None,
            })
            .collect();
        offsets.sort_unstable();
        offsets
    }

    fn member_names(&self, id: Word) -> HashMap<u32, &'a str> {
        let members = self.module.debug_names.iter().filter_map(|i| match i.operands.as_slice() {
            [Operand::IdRef(target), Operand::LiteralBit32(member), Operand::LiteralString(name)] if *target == id => {
                Some((*member, name.as_str()))
            }
            _ => None,
        });
        members.collect()
    }

    /// Scalar layout: the last member's offset plus its size.
    fn struct_size(&self, structure: &Instruction) -> Result<u32, String> {
        let id = structure.result_id.expect("a type has an id");
        let (member, offset) = *self.member_offsets(id).last().ok_or("a block without members")?;
        let last = structure.operands[member as usize].id_ref_any().expect("member type");
        Ok(offset + self.size(self.by_id[&last])?)
    }

    fn size(&self, ty: &Instruction) -> Result<u32, String> {
        let element = |operand: usize| self.by_id[&ty.operands[operand].id_ref_any().expect("element type")];
        let literal = |operand: &Operand| if let Operand::LiteralBit32(value) = operand { *value } else { 0 };
        match ty.class.opcode {
            Op::TypeInt | Op::TypeFloat => Ok(literal(&ty.operands[0]) / 8),
            Op::TypeVector => Ok(self.size(element(0))? * literal(&ty.operands[1])),
            Op::TypePointer => Ok(8),
            Op::TypeStruct => self.struct_size(ty),
            Op::TypeArray => Ok(self.size(element(0))? * literal(&element(1).operands[0])),
            other => Err(format!("a push constant of type {other:?} is not supported")),
        }
    }
}

/// Operand 6 of an image's type; `Unknown` where a sampled image or a declaration without a format has none.
fn image_format(element: &Instruction) -> String {
    match element.operands.get(6) {
        Some(Operand::ImageFormat(format)) => format!("{format:?}").to_lowercase(),
        _ => String::new(),
    }
}

fn name_of(instruction: &Instruction) -> Option<(Word, &str)> {
    match instruction.operands.as_slice() {
        [Operand::IdRef(id), Operand::LiteralString(name)] => Some((*id, name.as_str())),
        _ => None,
    }
}

fn ids_used_in_functions(module: &Module) -> HashSet<Word> {
    let instructions = module.functions.iter().flat_map(|f| &f.blocks).flat_map(|b| &b.instructions);
    instructions.flat_map(|i| &i.operands).filter_map(Operand::id_ref_any).collect()
}

fn local_size(module: &Module) -> [u32; 3] {
    let literal = |operand: &Operand| if let Operand::LiteralBit32(value) = operand { *value } else { 1 };
    let mode = module.execution_modes.iter().find(|i| i.operands.len() == 5);
    mode.map_or([1; 3], |i| [literal(&i.operands[2]), literal(&i.operands[3]), literal(&i.operands[4])])
}
