//! The machine that this runs on, as far as the system tells.

use std::thread;
use std::{env, fs};

/// Returns its name, one word; `UNKNOWN`, as OMPL has it, where there is none.
pub fn host() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let name = name.split_whitespace().next().unwrap_or("UNKNOWN");
    name.chars().filter(|letter| !letter.is_control()).collect()
}

/// Returns lines on its processors, named as `lscpu` names them.
pub fn hardware() -> Vec<String> {
    let mut lines = vec![format!("Architecture: {}", env::consts::ARCH)];
    lines.extend(thread::available_parallelism().ok().map(|count| format!("CPU(s): {count}")));
    let text = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    lines.extend(cpu_model(&text).map(|model| format!("Model name: {model}")));
    lines
}

/// Finds the model of the first processor in Linux's list.
fn cpu_model(text: &str) -> Option<&str> {
    let values = text.lines().filter_map(|line| line.split_once(':'));
    let mut models = values.filter(|(name, _)| name.trim() == "model name").map(|(_, value)| value.trim());
    models.find(|value| !value.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn model_is_that_of_the_first_processor() {
        let text =
            "processor\t: 0\nvendor_id\t: A\nmodel\t\t: 85\nmodel name\t: A CPU @ 2.00GHz: fast\nmodel name\t: B\n";
        assert_eq!(cpu_model(text), Some("A CPU @ 2.00GHz: fast"));
        assert_eq!(cpu_model("processor\t: 0\nmodel name\t:\n"), None);
    }

    #[test]
    fn host_is_one_word() {
        assert_eq!(host().split_whitespace().count(), 1);
    }
}
