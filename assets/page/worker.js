// The module in a separate thread, so that the page keeps playing while planners plan. Requests and answers are strings.

const waiting = [];
let exports = null;
let failure = null;

function textAt(start, bytes) {
    return new TextDecoder().decode(new Uint8Array(exports.memory.buffer, start, bytes));
}

function ask(request) {
    if (failure !== null) return JSON.stringify({ error: { message: failure } });
    const bytes = new TextEncoder().encode(request);
    try {
        const start = exports.request_buffer(bytes.length);
        // The memory may have grown, which replaces its buffer.
        new Uint8Array(exports.memory.buffer, start, bytes.length).set(bytes);
        const length = exports.answer();
        return textAt(exports.answer_start(), length);
    } catch (error) {
        const words = textAt(exports.fault_start(), exports.fault_bytes());
        failure = words === "" ? `the module stopped: ${error.message}` : `the module crashed, which is a bug: ${words}`;
        return JSON.stringify({ error: { message: failure, isFatal: true } });
    }
}

onmessage = async ({ data }) => {
    if (data.module === undefined) {
        if (exports === null) waiting.push(data);
        else postMessage({ number: data.number, answer: ask(data.request) });
        return;
    }
    exports = (await WebAssembly.instantiate(data.module, {})).exports;
    for (const { number, request } of waiting.splice(0)) postMessage({ number, answer: ask(request) });
};
