//! Injects the counting of instructions into a module, so that every engine counts alike.
//!
//! Each straight run of instructions first takes its length from a global, [`GAS`], and traps when nothing is left
//! (the metering of W. Wang et al. and of `wasm-instrument`, here for today's instructions). `block`, `loop`, `else`,
//! `end` and `nop` count nothing. An instruction that works on many bytes, such as `memory.copy`, also counts one for
//! each eight of them.
//!
//! Bits of NaNs, which differ between processors, can be seen in memory, in integers and in signs alone: before they get
//! there, every NaN becomes the canonical one.

use wasm_encoder::reencode::{self, Reencode, utils};
use wasm_encoder::{
    BlockType, CodeSection, ConstExpr, ExportKind, ExportSection, Function, GlobalSection, GlobalType, Instruction,
    Module, SectionId, ValType,
};
use wasmparser::{FunctionBody, Operator, Parser, Payload, TypeRef, Validator, WasmFeatures};

/// The name under which a counted module exports what is left of its instructions: an i64, negative once it is spent.
pub const GAS: &str = "wildfire:gas";

/// Bytes that count as one instruction.
pub const BYTES_PER_INSTRUCTION: u64 = 8;

/// What a module may use: WebAssembly 2.0 without vectors, and constants that are computed.
const FEATURES: WasmFeatures = WasmFeatures::WASM2.difference(WasmFeatures::SIMD).union(WasmFeatures::EXTENDED_CONST);

/// Checks a module, and returns it with its instructions counted.
///
/// # Errors
/// A sentence that says what is wrong with the module; it reads well after the module's name.
pub fn counted(bytes: &[u8]) -> Result<Vec<u8>, String> {
    if !bytes.starts_with(b"\0asm") {
        return Err("is not a WebAssembly module: it does not begin with `\\0asm`".to_owned());
    }
    Validator::new_with_features(FEATURES)
        .validate_all(bytes)
        .map_err(|error| format!("is not a valid module: {} at byte {}", error.message(), error.offset()))?;
    let mut counter = Counter::of(bytes).map_err(|error| error.to_string())?;
    if counter.has_start {
        return Err("has a start function, which would run before it is asked; build it as a command".to_owned());
    }
    let mut module = Module::new();
    counter.parse_core_module(&mut module, Parser::new(0), bytes).map_err(|error| match error {
        reencode::Error::UserError(message) => message,
        other => format!("is not a module that can be counted: {other}"),
    })?;
    Ok(module.finish())
}

/// Rewrites a module section by section.
struct Counter {
    /// The number of the global that holds what is left.
    gas: u32,
    /// The parameters of each function that the module defines.
    parameters: Vec<u32>,
    has_start: bool,
    has_globals: bool,
    has_exports: bool,
}

impl Counter {
    /// Reads what the rewriting needs to know beforehand.
    fn of(bytes: &[u8]) -> wasmparser::Result<Self> {
        let mut counter =
            Self { gas: 0, parameters: Vec::new(), has_start: false, has_globals: false, has_exports: false };
        let mut types = Vec::new();
        for payload in Parser::new(0).parse_all(bytes) {
            match payload? {
                Payload::TypeSection(section) => {
                    for function in section.into_iter_err_on_gc_types() {
                        types.push(function?.params().len() as u32);
                    }
                }
                Payload::ImportSection(imports) => {
                    for import in imports {
                        counter.gas += u32::from(matches!(import?.ty, TypeRef::Global(_)));
                    }
                }
                Payload::FunctionSection(functions) => {
                    for index in functions {
                        counter.parameters.push(types[index? as usize]);
                    }
                }
                Payload::GlobalSection(globals) => counter.gas += globals.count(),
                Payload::StartSection { .. } => counter.has_start = true,
                _ => {}
            }
        }
        Ok(counter)
    }

    fn add_gas(&self, globals: &mut GlobalSection) {
        let of = GlobalType { val_type: ValType::I64, mutable: true, shared: false };
        globals.global(of, &ConstExpr::i64_const(0));
    }

    fn export_gas(&self, exports: &mut ExportSection) {
        exports.export(GAS, ExportKind::Global, self.gas);
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

    /// Writes what an instruction needs in front of it; what it works on is on top of the stack.
    fn prepare(&self, body: &mut Function, operator: &Operator<'_>, scratch: &Scratch) {
        match operator {
            Operator::MemoryCopy { .. }
            | Operator::MemoryFill { .. }
            | Operator::MemoryInit { .. }
            | Operator::TableCopy { .. }
            | Operator::TableFill { .. }
            | Operator::TableInit { .. } => {
                body.instruction(&Instruction::LocalTee(scratch.length));
                let shift = Instruction::I64Const(i64::from(BYTES_PER_INSTRUCTION.ilog2()));
                let length = [Instruction::LocalGet(scratch.length), Instruction::I64ExtendI32U];
                self.take(body, &[length[0].clone(), length[1].clone(), shift, Instruction::I64ShrU]);
            }
            Operator::F64Store { .. } | Operator::I64ReinterpretF64 | Operator::F64Copysign => {
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

    fn parse_global_section(
        &mut self,
        globals: &mut GlobalSection,
        section: wasmparser::GlobalSectionReader<'_>,
    ) -> Result<(), reencode::Error<String>> {
        utils::parse_global_section(self, globals, section)?;
        self.add_gas(globals);
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
            if export.name == GAS {
                return Err(reencode::Error::UserError(format!("exports `{GAS}`, a name that is taken")));
            }
            self.parse_export(exports, export);
        }
        self.export_gas(exports);
        self.has_exports = true;
        Ok(())
    }

    fn intersperse_section_hook(
        &mut self,
        module: &mut Module,
        _after: Option<SectionId>,
        before: Option<SectionId>,
    ) -> Result<(), reencode::Error<String>> {
        let is_beyond = |section: SectionId| before.is_none_or(|before| place(before) > place(section));
        if !self.has_globals && is_beyond(SectionId::Global) {
            let mut globals = GlobalSection::new();
            self.add_gas(&mut globals);
            module.section(&globals);
            self.has_globals = true;
        }
        if !self.has_exports && is_beyond(SectionId::Export) {
            let mut exports = ExportSection::new();
            self.export_gas(&mut exports);
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
        let mut locals = Vec::new();
        let mut count = self.parameters[code.len() as usize];
        for pair in function.get_locals_reader()? {
            let (number, of) = pair?;
            count += number;
            locals.push((number, self.val_type(of)?));
        }
        let scratch = Scratch { length: count, double: count + 1, single: count + 2 };
        locals.extend([(1, ValType::I32), (1, ValType::F64), (1, ValType::F32)]);
        let mut body = Function::new(locals);
        let operators: Vec<Operator<'_>> = function.get_operators_reader()?.into_iter().collect::<Result<_, _>>()?;
        let mut from = 0;
        while from < operators.len() {
            let to = from + operators[from..].iter().position(ends_run).map_or(operators.len() - from, |at| at + 1);
            let cost = operators[from..to].iter().filter(|operator| is_counted(operator)).count();
            if cost > 0 {
                self.take(&mut body, &[Instruction::I64Const(cost as i64)]);
            }
            for operator in &operators[from..to] {
                self.prepare(&mut body, operator, &scratch);
                body.instruction(&self.instruction(operator.clone())?);
            }
            from = to;
        }
        code.function(&body);
        Ok(())
    }
}
