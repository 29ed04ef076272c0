// A policy that picks one of its options at random, the same for the same seed. As a WebAssembly module:
//   rustup target add wasm32-wasip1
//   rustc --edition 2024 -O -C strip=symbols --target wasm32-wasip1 whim.rs -o whim.wasm

use std::io::{self, BufRead, Write};

/// Whole numbers by xorshift64* (Vigna, "An experimental exploration of Marsaglia's xorshift generators, scrambled", 2016).
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize) % bound
    }
}

/// What stands between a key and the next text, from a place on.
fn between<'a>(line: &'a str, key: &str, end: &str) -> Option<&'a str> {
    let from = line.find(key)? + key.len();
    Some(&line[from..from + line[from..].find(end)?])
}

fn number(line: &str, key: &str) -> u64 {
    let digits = line.find(key).map_or("", |at| &line[at + key.len()..]);
    digits.chars().take_while(char::is_ascii_digit).fold(0, |sum, digit| 10 * sum + u64::from(digit as u32 - '0' as u32))
}

/// An option for each agent that is asked and has one.
fn choices(line: &str, random: &mut Random) -> String {
    let asked = between(line, "\"agents\":[", "]").unwrap_or_default();
    let state = line.find("\"state\":").map_or("", |at| &line[at..]);
    let mut choices = Vec::new();
    for agent in state.split("{\"agent\":\"").skip(1) {
        let name = agent.split('"').next().unwrap_or_default();
        let options = between(agent, "\"options\":[[", "]]").unwrap_or_default();
        let cells: Vec<&str> = options.split("],[").filter(|cell| !cell.is_empty()).collect();
        if asked.contains(&format!("\"{name}\"")) && !cells.is_empty() {
            let cell = cells[random.below(cells.len())];
            choices.push(format!("{{\"agent\":\"{name}\",\"cell\":[{cell}]}}"));
        }
    }
    choices.join(",")
}

fn main() {
    let mut random = Random(1);
    for line in io::stdin().lock().lines() {
        let Ok(line) = line else { return };
        let line = line.replace(' ', "");
        let answer = match between(&line, "\"type\":\"", "\"") {
            Some("hello") => "{\"type\":\"hello\",\"protocol\":1,\"name\":\"whim\",\"version\":\"1\"}".to_owned(),
            Some("field") => {
                random = Random(number(&line, "\"seed\":") | 1);
                "{\"type\":\"ready\"}".to_owned()
            }
            Some("ask") => {
                let id = number(&line, "\"id\":");
                format!("{{\"type\":\"answer\",\"id\":{id},\"choices\":[{}]}}", choices(&line, &mut random))
            }
            _ => return,
        };
        println!("{answer}");
        io::stdout().flush().expect("somebody reads");
    }
}
