//! Injects the counting of instructions and of nested calls into a module, so that every engine counts alike and stops
//! at the same place.
//!
//! Each straight run of instructions first takes its length from a global, [`GAS`], and traps when nothing is left
//! (the metering of W. Wang et al. and of `wasm-instrument`, here for today's instructions). `block`, `loop`, `else`,
//! `end` and `nop` count nothing. An instruction that works on many bytes, such as `memory.copy`, also counts one for
//! each eight of them.
//!
//! A function that calls others first takes the slots of its frame from another global, [`SLOTS`]: its locals, the most
//! values that it has on its stack, and [`FRAME_SLOTS`]. It gives them back when it returns, so recursion ends at a depth
//! that depends on the module alone. The frame of a function that calls nobody is the last one and is not counted.
//!
//! Bits of NaNs, which differ between processors, can be seen in memory, in integers and in signs alone: before they get
//! there, every NaN becomes the canonical one.

use wasm_encoder::reencode::{self, Reencode, utils};
use wasm_encoder::{
    BlockType, CodeSection, ConstExpr, ExportKind, ExportSection, Function, GlobalSection, GlobalType, Instruction,
    Module, SectionId, TypeSection, ValType,
};
use wasmparser::{
    BinaryReaderError, ExternalKind, FuncType, FunctionBody, Operator, Parser, Payload, TypeRef, ValidPayload,
    Validator, WasmFeatures,
};

/// The name under which a counted module exports what is left of its instructions: an i64, negative once it is spent.
pub const GAS: &str = "wildfire:gas";

/// The name under which it exports what is left of its slots for nested calls: an i32, negative once they are spent.
pub const SLOTS: &str = "wildfire:slots";

/// Slots of nested calls, eight bytes each in an interpreter. Engines need room for some multiple of them.
pub const MAX_SLOTS: i32 = 1 << 20;

/// Slots of a frame besides its values: where it returns to, and registers that it saves.
pub const FRAME_SLOTS: u32 = 8;

/// Bytes that count as one instruction.
pub const BYTES_PER_INSTRUCTION: u64 = 8;

const BYTES_PER_PAGE: u64 = 1 << 16;

/// What a module may use: WebAssembly 2.0 without vectors, and constants that are computed.
const FEATURES: WasmFeatures = WasmFeatures::WASM2.difference(WasmFeatures::SIMD).union(WasmFeatures::EXTENDED_CONST);

/// A module whose instructions are counted, and what it needs.
#[derive(Clone, Debug)]
pub struct Counted {
    pub bytes: Vec<u8>,
    pub imports: Vec<Import>,
    /// Bytes of its exported memory at the beginning; `None` if it exports none.
    pub memory: Option<u64>,
    /// Whether it exports a function `_start` without parameters and results.
    pub has_start: bool,
}

/// Something that a module imports.
#[derive(Clone, Debug)]
pub struct Import {
    pub module: String,
    pub name: String,
    /// The type of a function; `None` of anything else.
    pub of: Option<FuncType>,
}

/// Checks a module, and returns it with its instructions counted.
///
/// # Errors
/// A sentence that says what is wrong with the module; it reads well after the module's name.
pub fn counted(bytes: &[u8]) -> Result<Counted, String> {
    if !bytes.starts_with(b"\0asm") {
        return Err("is not a WebAssembly module: it does not begin with `\\0asm`".to_owned());
    }
    let mut counter = Counter::of(bytes)
        .map_err(|error| format!("is not a valid module: {} at byte {}", error.message(), error.offset()))?;
    if counter.begins_by_itself {
        return Err("has a start function, which would run before its first query; build it as a command".to_owned());
    }
    let mut module = Module::new();
    counter.parse_core_module(&mut module, Parser::new(0), bytes).map_err(|error| match error {
        reencode::Error::UserError(message) => message,
        other => format!("is not a module that can be counted: {other}"),
    })?;
    let Counter { imports, memory, exports_memory, has_start, .. } = counter;
    Ok(Counted { bytes: module.finish(), imports, memory: exports_memory.then_some(memory), has_start })
}

/// Rewrites a module section by section.
#[derive(Default)]
struct Counter {
    /// The number of the global that holds what is left of the instructions; the next one holds that of the slots.
    gas: u32,
    types: Vec<FuncType>,
    /// The functions that the module defines.
    functions: Vec<Defined>,
    imports: Vec<Import>,
    /// Bytes of memory at the beginning.
    memory: u64,
    exports_memory: bool,
    /// Whether it exports `_start` as a command does.
    has_start: bool,
    /// Whether it has a function that runs before any other.
    begins_by_itself: bool,
    has_globals: bool,
    has_exports: bool,
}

/// A function that a module defines.
#[derive(Clone, Copy)]
struct Defined {
    /// The number of its type.
    of: u32,
    /// The slots of its frame; 0 if it calls no other.
    slots: u32,
}

impl Counter {
    /// Validates a module and reads what the rewriting needs to know first.
    fn of(bytes: &[u8]) -> Result<Self, BinaryReaderError> {
        let mut counter = Self::default();
        let mut validator = Validator::new_with_features(FEATURES);
        let mut defined = 0;
        for payload in Parser::new(0).parse_all(bytes) {
            let payload = payload?;
            if let ValidPayload::Func(function, body) = validator.payload(&payload)? {
                let mut function = function.into_validator(Default::default());
                let mut reader = body.get_binary_reader();
                function.read_locals(&mut reader)?;
                let (mut highest, mut calls) = (0, false);
                let mut operators = body.get_operators_reader()?;
                while !operators.eof() {
                    let (operator, offset) = operators.read_with_offset()?;
                    function.op(offset, &operator)?;
                    // The validator takes this height from the code alone, whatever registers an engine uses.
                    highest = highest.max(function.operand_stack_height());
                    calls |= matches!(operator, Operator::Call { .. } | Operator::CallIndirect { .. });
                }
                function.finish(operators.original_position())?;
                // A frame without calls is always the last, so it adds nothing to the depth of a recursion.
                if calls {
                    // The function section comes first and announces as many, as the validator has checked.
                    counter.functions[defined].slots = function.len_locals() + highest + FRAME_SLOTS;
                }
                defined += 1;
            }
            match payload {
                Payload::TypeSection(section) => {
                    // A GC type would have failed validation already.
                    counter.types = section.into_iter_err_on_gc_types().collect::<Result<_, _>>()?;
                }
                Payload::ImportSection(imports) => {
                    for import in imports {
                        let import = import?;
                        // Imported globals have the first numbers, so those that are added come after them.
                        counter.gas += u32::from(matches!(import.ty, TypeRef::Global(_)));
                        let of = match import.ty {
                            // Types come before imports, and the validator has checked the index.
                            TypeRef::Func(of) => Some(counter.types[of as usize].clone()),
                            _ => None,
                        };
                        let module = import.module.to_owned();
                        let name = import.name.to_owned();
                        counter.imports.push(Import { module, name, of });
                    }
                }
                Payload::FunctionSection(functions) => {
                    for of in functions {
                        counter.functions.push(Defined { of: of?, slots: 0 });
                    }
                }
                Payload::MemorySection(memories) => {
                    for memory in memories {
                        // There is no more than one, of up to 65,536 pages: neither the sum nor the product overflows.
                        counter.memory += memory?.initial * BYTES_PER_PAGE;
                    }
                }
                Payload::GlobalSection(globals) => counter.gas += globals.count(),
                Payload::ExportSection(exports) => {
                    for export in exports {
                        let export = export?;
                        match (export.name, export.kind) {
                            ("memory", ExternalKind::Memory) => counter.exports_memory = true,
                            ("_start", ExternalKind::Func) => counter.has_start = counter.is_command(export.index),
                            _ => {}
                        }
                    }
                }
                Payload::StartSection { .. } => counter.begins_by_itself = true,
                _ => {}
            }
        }
        Ok(counter)
    }

    /// Returns whether a function, by its number after those that are imported, neither takes nor returns anything.
    fn is_command(&self, index: u32) -> bool {
        let imported = self.imports.iter().filter(|import| import.of.is_some()).count();
        let defined = (index as usize).checked_sub(imported).and_then(|index| self.functions.get(index));
        defined.is_some_and(|function| {
            let of = &self.types[function.of as usize];
            of.params().is_empty() && of.results().is_empty()
        })
    }

    fn add_globals(&self, globals: &mut GlobalSection) {
        let of = |val_type| GlobalType { val_type, mutable: true, shared: false };
        // Nothing may run before a budget is set.
        globals.global(of(ValType::I64), &ConstExpr::i64_const(0));
        globals.global(of(ValType::I32), &ConstExpr::i32_const(MAX_SLOTS));
    }

    fn export_globals(&self, exports: &mut ExportSection) {
        exports.export(GAS, ExportKind::Global, self.gas);
        exports.export(SLOTS, ExportKind::Global, self.gas + 1);
    }

    /// Takes from what is left the number on the stack that `amount` pushes, an i64, and traps if that is too much.
    fn take(&self, body: &mut Function, amount: &[Instruction<'_>]) {
        body.instruction(&Instruction::GlobalGet(self.gas));
        for instruction in amount {
            body.instruction(instruction);
        }
        body.instruction(&Instruction::I64Sub)
            .instruction(&Instruction::GlobalSet(self.gas))
            .instruction(&Instruction::GlobalGet(self.gas))
            .instruction(&Instruction::I64Const(0))
            .instruction(&Instruction::I64LtS)
            .instruction(&Instruction::If(BlockType::Empty))
            .instruction(&Instruction::Unreachable)
            .instruction(&Instruction::End);
    }

    /// Takes the slots of a frame, and traps if that is too much; then opens a block in which the whole function stands,
    /// so that every way out of it leads to its end.
    fn enter(&self, body: &mut Function, function: Defined) {
        body.instruction(&Instruction::GlobalGet(self.gas + 1))
            .instruction(&Instruction::I32Const(function.slots as i32))
            .instruction(&Instruction::I32Sub)
            .instruction(&Instruction::GlobalSet(self.gas + 1))
            .instruction(&Instruction::GlobalGet(self.gas + 1))
            .instruction(&Instruction::I32Const(0))
            .instruction(&Instruction::I32LtS)
            .instruction(&Instruction::If(BlockType::Empty))
            .instruction(&Instruction::Unreachable)
            .instruction(&Instruction::End)
            // The type of a block that takes nothing and leaves what the function returns.
            .instruction(&Instruction::Block(BlockType::FunctionType(self.types.len() as u32 + function.of)));
    }

    /// Closes that block and gives the slots back.
    fn leave(&self, body: &mut Function, function: Defined) {
        body.instruction(&Instruction::End)
            .instruction(&Instruction::GlobalGet(self.gas + 1))
            .instruction(&Instruction::I32Const(function.slots as i32))
            .instruction(&Instruction::I32Add)
            .instruction(&Instruction::GlobalSet(self.gas + 1));
    }

    /// Writes what an instruction needs in front of it; what it works on is on top of the stack.
    fn prepare(&self, body: &mut Function, operator: &Operator<'_>, scratch: &Scratch) {
        match operator {
            Operator::MemoryCopy { .. }
            | Operator::MemoryFill { .. }
            | Operator::MemoryInit { .. }
            | Operator::TableCopy { .. }
            | Operator::TableFill { .. }
            | Operator::TableInit { .. } => {
                // All six have their length, an i32, on top of the stack.
                body.instruction(&Instruction::LocalTee(scratch.length));
                let shift = Instruction::I64Const(i64::from(BYTES_PER_INSTRUCTION.ilog2()));
                // Lengths are unsigned: by sign extension those of 2 GiB and more would add to what is left.
                let length = [Instruction::LocalGet(scratch.length), Instruction::I64ExtendI32U];
                self.take(body, &[length[0].clone(), length[1].clone(), shift, Instruction::I64ShrU]);
            }
            // Of `copysign` only the operand on top matters, whose sign bit gets into the result.
            Operator::F64Store { .. } | Operator::I64ReinterpretF64 | Operator::F64Copysign => {
                // `select` keeps a value that equals itself, as all but NaNs do.
                body.instruction(&Instruction::LocalTee(scratch.double))
                    .instruction(&Instruction::F64Const(f64::NAN))
                    .instruction(&Instruction::LocalGet(scratch.double))
                    .instruction(&Instruction::LocalGet(scratch.double))
                    .instruction(&Instruction::F64Eq)
                    .instruction(&Instruction::Select);
            }
            Operator::F32Store { .. } | Operator::I32ReinterpretF32 | Operator::F32Copysign => {
                body.instruction(&Instruction::LocalTee(scratch.single))
                    .instruction(&Instruction::F32Const(f32::NAN))
                    .instruction(&Instruction::LocalGet(scratch.single))
                    .instruction(&Instruction::LocalGet(scratch.single))
                    .instruction(&Instruction::F32Eq)
                    .instruction(&Instruction::Select);
            }
            _ => {}
        }
    }
}

/// The place of a section in a module.
fn place(section: SectionId) -> u8 {
    // The number of data segments stands before the code, although its section has a higher number.
    match section {
        SectionId::DataCount => u8::from(SectionId::Element),
        other => u8::from(other),
    }
}

/// Whether control may go elsewhere after an instruction, or come from elsewhere to the next one.
fn ends_run(operator: &Operator<'_>) -> bool {
    matches!(
        operator,
        Operator::Loop { .. }
            | Operator::If { .. }
            | Operator::Else
            | Operator::End
            | Operator::Br { .. }
            | Operator::BrIf { .. }
            | Operator::BrTable { .. }
            | Operator::Return
            | Operator::Unreachable
    )
}

fn is_counted(operator: &Operator<'_>) -> bool {
    !matches!(operator, Operator::Block { .. } | Operator::Loop { .. } | Operator::Else | Operator::End | Operator::Nop)
}

/// Locals that a function needs besides its own.
struct Scratch {
    length: u32,
    double: u32,
    single: u32,
}

impl Reencode for Counter {
    type Error = String;

    fn parse_type_section(
        &mut self,
        types: &mut TypeSection,
        section: wasmparser::TypeSectionReader<'_>,
    ) -> Result<(), reencode::Error<String>> {
        utils::parse_type_section(self, types, section)?;
        for of in self.types.clone() {
            let results: Vec<_> = of.results().iter().map(|&result| self.val_type(result)).collect::<Result<_, _>>()?;
            types.ty().function([], results);
        }
        Ok(())
    }

    fn parse_custom_section(
        &mut self,
        _module: &mut Module,
        _section: wasmparser::CustomSectionReader<'_>,
    ) -> Result<(), reencode::Error<String>> {
        // Names, and places in sources that are no longer right.
        Ok(())
    }

    fn parse_global_section(
        &mut self,
        globals: &mut GlobalSection,
        section: wasmparser::GlobalSectionReader<'_>,
    ) -> Result<(), reencode::Error<String>> {
        utils::parse_global_section(self, globals, section)?;
        self.add_globals(globals);
        self.has_globals = true;
        Ok(())
    }

    fn parse_export_section(
        &mut self,
        exports: &mut ExportSection,
        section: wasmparser::ExportSectionReader<'_>,
    ) -> Result<(), reencode::Error<String>> {
        for export in section {
            let export = export?;
            if [GAS, SLOTS].contains(&export.name) {
                return Err(reencode::Error::UserError(format!("exports `{}`, a reserved name", export.name)));
            }
            self.parse_export(exports, export);
        }
        self.export_globals(exports);
        self.has_exports = true;
        Ok(())
    }

    fn intersperse_section_hook(
        &mut self,
        module: &mut Module,
        _after: Option<SectionId>,
        before: Option<SectionId>,
    ) -> Result<(), reencode::Error<String>> {
        // Sections stand in a fixed order, so a missing one is written before the first that comes after it.
        let is_beyond = |section: SectionId| before.is_none_or(|before| place(before) > place(section));
        if !self.has_globals && is_beyond(SectionId::Global) {
            let mut globals = GlobalSection::new();
            self.add_globals(&mut globals);
            module.section(&globals);
            self.has_globals = true;
        }
        if !self.has_exports && is_beyond(SectionId::Export) {
            let mut exports = ExportSection::new();
            self.export_globals(&mut exports);
            module.section(&exports);
            self.has_exports = true;
        }
        Ok(())
    }

    fn parse_function_body(
        &mut self,
        code: &mut CodeSection,
        function: FunctionBody<'_>,
    ) -> Result<(), reencode::Error<String>> {
        // Bodies come in the order of the function section, so the number of those written is the index.
        let defined = self.functions[code.len() as usize];
        let mut locals = Vec::new();
        // Parameters are the first locals.
        let mut count = self.types[defined.of as usize].params().len() as u32;
        for pair in function.get_locals_reader()? {
            let (number, of) = pair?;
            count += number;
            locals.push((number, self.val_type(of)?));
        }
        // Behind the function's own locals, whose numbers stay as they are.
        let scratch = Scratch { length: count, double: count + 1, single: count + 2 };
        locals.extend([(1, ValType::I32), (1, ValType::F64), (1, ValType::F32)]);
        let mut body = Function::new(locals);
        let operators: Vec<Operator<'_>> = function.get_operators_reader()?.into_iter().collect::<Result<_, _>>()?;
        let is_counted_in = defined.slots > 0;
        if is_counted_in {
            self.enter(&mut body, defined);
        }
        // Blocks that are open where the next instruction stands.
        let mut open = 0u32;
        let mut from = 0;
        while from < operators.len() {
            // The instruction that ends a run is executed with it, so it is paid with it.
            let to = from + operators[from..].iter().position(ends_run).map_or(operators.len() - from, |at| at + 1);
            let cost = operators[from..to].iter().filter(|operator| is_counted(operator)).count();
            // A run of nothing but ends of blocks costs nothing, so it needs no code.
            if cost > 0 {
                self.take(&mut body, &[Instruction::I64Const(cost as i64)]);
            }
            for (index, operator) in operators.iter().enumerate().take(to).skip(from) {
                match operator {
                    Operator::Block { .. } | Operator::Loop { .. } | Operator::If { .. } => open += 1,
                    // The last end closes the function itself, around which no block is open.
                    Operator::End => open = open.saturating_sub(1),
                    _ => {}
                }
                match operator {
                    // A return would not give the slots back, so it leaves by the block around the whole function.
                    Operator::Return if is_counted_in => {
                        body.instruction(&Instruction::Br(open));
                    }
                    _ => {
                        // A path that falls off the end must give the slots back too.
                        if is_counted_in && index + 1 == operators.len() {
                            self.leave(&mut body, defined);
                        }
                        self.prepare(&mut body, operator, &scratch);
                        body.instruction(&self.instruction(operator.clone())?);
                    }
                }
            }
            from = to;
        }
        code.function(&body);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counting_is_repeatable_and_counting_twice_is_refused() {
        let bytes =
            wat::parse_str(r#"(module (memory (export "memory") 1) (func (export "_start")))"#).expect("a module");
        let once = counted(&bytes).expect("a module").bytes;
        assert_eq!(once, counted(&bytes).expect("a module").bytes);
        assert!(counted(&once).is_err());
    }
}
