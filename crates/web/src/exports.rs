//! The module's exports: texts in and out of one memory.
//!
//! A page writes a request where [`request_buffer`] says, calls [`answer`], and reads the answer where [`answer_start`] says.
//! A module stops at a fault of the program; [`fault_start`] says what it was.

use std::cell::RefCell;
use std::panic;

use crate::Session;

/// What passes through the memory.
#[derive(Default)]
struct Server {
    session: Session,
    request: Vec<u8>,
    answer: Vec<u8>,
}

thread_local! {
    static DESK: RefCell<Server> = RefCell::default();
    static FAULT: RefCell<String> = RefCell::default();
}

/// Makes room for a request of so many bytes, and returns where it is to be written.
#[unsafe(no_mangle)]
pub extern "C" fn request_buffer(bytes: usize) -> *mut u8 {
    DESK.with_borrow_mut(|desk| {
        desk.request.clear();
        desk.request.resize(bytes, 0);
        desk.request.as_mut_ptr()
    })
}

/// Answers the request in the buffer, and returns how many bytes the answer has.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    panic::set_hook(Box::new(|fault| FAULT.set(fault.to_string())));
    DESK.with_borrow_mut(|desk| {
        let request = String::from_utf8_lossy(&desk.request);
        desk.answer = desk.session.answer(&request).into_bytes();
        desk.answer.len()
    })
}

/// Returns where the last answer is.
#[unsafe(no_mangle)]
pub extern "C" fn answer_start() -> *const u8 {
    DESK.with_borrow(|desk| desk.answer.as_ptr())
}

/// Returns how many bytes the words about a fault have; none where there was none.
#[unsafe(no_mangle)]
pub extern "C" fn fault_bytes() -> usize {
    FAULT.with_borrow(String::len)
}

/// Returns where the words about a fault are.
#[unsafe(no_mangle)]
pub extern "C" fn fault_start() -> *const u8 {
    FAULT.with_borrow(|fault| fault.as_ptr())
}
