// Runs of the module in node against those of the native program: their recordings, byte for byte.
//
//     node .ci/web_rows.mjs MODULE PROGRAM [SEEDS]
//
// MODULE is a file of WebAssembly, or a page that contains one.
// Every scenario below with every planner and so many seeds, 1 unless told. Prints how many were equal, and the medians of
// CPU time of `contest` in both.

import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { inflateSync } from "node:zlib";

const [modulePath, program, seeds = "1"] = process.argv.slice(2);
const SCENARIOS = ["contest", "contest-1", "report-2024", "coursework-2025", "original-2024", "arena", "dense", "cautious", "fleet", "windy", "smoke"];
const PLANNERS = ["prm+primitives", "prm-rs", "hybrid-astar", "lattice"];

function moduleBytes(path) {
    if (!path.endsWith(".html")) return readFileSync(path);
    const packed = readFileSync(path, "latin1").match(/ id="module">([^<]+)</)[1];
    return inflateSync(Buffer.from(packed, "base64"));
}

const { instance } = await WebAssembly.instantiate(moduleBytes(modulePath), {});
const module = instance.exports;

function ask(request) {
    const bytes = new TextEncoder().encode(JSON.stringify(request));
    const start = module.request_buffer(bytes.length);
    // The memory may have grown by then, which gives it another buffer.
    new Uint8Array(module.memory.buffer, start, bytes.length).set(bytes);
    const length = module.answer();
    const answered = JSON.parse(new TextDecoder().decode(new Uint8Array(module.memory.buffer, module.answer_start(), length)));
    if (answered.error) throw new Error(answered.error.message);
    return answered;
}

function median(values) {
    const sorted = [...values].sort((one, other) => one - other);
    return sorted[sorted.length >> 1];
}

const folder = mkdtempSync(join(tmpdir(), "wildfire-"));
let [equal, times] = [0, { here: [], native: [] }];
const different = [];
for (const scenario of SCENARIOS) {
    for (const planner of PLANNERS) {
        for (let seed = 1; seed <= Number(seeds); seed++) {
            const begin = process.cpuUsage();
            ask({ do: "open", scenario: { name: scenario }, changes: [`unimog.planner=${planner}`], seed });
            ask({ do: "advance", to_ns: 1e18 });
            const spent = process.cpuUsage(begin);
            const recording = Buffer.from(ask({ do: "finish" }).recording, "base64");
            const file = join(folder, "run.wildfire");
            const options = ["run", scenario, "--seed", `${seed}`, "--set", `unimog.planner=${planner}`, "--out", file, "--json"];
            const native = JSON.parse(execFileSync(program, options, { encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] }));
            if (readFileSync(file).equals(recording)) equal++;
            else different.push(`${scenario} ${planner} ${seed}`);
            if (scenario === "contest") {
                times.here.push((spent.user + spent.system) / 1e3);
                times.native.push(native.measured.cpu_run_s * 1e3);
            }
        }
    }
}
rmSync(folder, { recursive: true });
console.log(`${equal} of ${equal + different.length} recordings are those of the native program, byte for byte`);
const [here, native] = [median(times.here), median(times.native)];
console.log(`contest: ${here.toFixed(1)} ms of CPU in the module, ${native.toFixed(1)} ms native (medians), ${(here / native).toFixed(2)} x`);
if (different.length > 0) {
    console.error(`FAILED: different are ${different.join(", ")}`);
    console.error(".ci/wasm and .ci/renew make a new module for assets/play.html");
    process.exit(1);
}
