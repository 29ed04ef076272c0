//! `wildfire lessons`: pages for a course, whose data this program computes when it writes them.

mod curves;
mod grids;
mod runs;

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use rand::seq::SliceRandom;
use serde_json::Value;

use crate::cli::error::CliError;
use crate::cli::output_files::write_all;
use wildfire_base::document::escaped_html;
use wildfire_base::rng;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::plan::PROGRAM_VERSION;

const TEMPLATE: &str = include_str!("../../../assets/lessons/lesson.html");
const STYLES: [&str; 2] =
    [include_str!("../../../assets/page/page.css"), include_str!("../../../assets/page/lesson.css")];
const SCRIPT: &str = include_str!("../../../assets/page/lesson.js");

/// Answers of a question.
const ANSWERS: usize = 4;

#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  wildfire lessons course")]
pub struct LessonsArguments {
    /// Folder for the pages; it is created if it is missing.
    #[arg(value_name = "FOLDER", default_value = "lessons")]
    pub folder: PathBuf,
}

/// A lesson: its text, and the data that its widgets show.
struct Lesson {
    file: &'static str,
    title: &'static str,
    text: &'static str,
    data: fn() -> Result<Value, CliError>,
}

/// Makes the lessons, in the order in which they are read, from their names, titles and data.
macro_rules! lessons {
    ($($name:literal, $title:literal, $data:expr;)*) => {
        [$(Lesson {
            file: concat!($name, ".html"),
            title: $title,
            text: include_str!(concat!("../../../assets/lessons/", $name, ".html")),
            data: $data,
        }),*]
    };
}

const LESSONS: [Lesson; 7] = lessons! {
    "1-fronts", "Brushfire and wavefront", || Ok(grids::fronts());
    "2-astar", "A* and its relatives", || Ok(grids::searches());
    "3-potentials", "Potential fields and local minima", || Ok(grids::potentials());
    "4-sampling", "Sampling: PRM, RRT and RRT*", || Ok(grids::samples());
    "5-curves", "Curves for cars", || Ok(curves::curves());
    "6-intervals", "Confidence intervals", runs::pairs;
    "7-dispatch", "Which truck takes which fire?", runs::dispatch;
};

/// Writes all lessons and their index to a folder, which is created if it is missing.
pub fn write(folder: &Path, quiet: bool) -> Result<(), CliError> {
    fs::create_dir_all(folder).map_err(|error| CliError::unwritable(folder, &error))?;
    let mut pages = vec![(folder.join("index.html"), index())];
    let texts = with_shuffled_answers(&LESSONS.map(|lesson| lesson.text));
    for (number, (lesson, text)) in LESSONS.iter().zip(&texts).enumerate() {
        let data = (lesson.data)()?;
        pages.push((folder.join(lesson.file), page(number, text, &data)));
    }
    for (path, page) in &pages {
        write_all(&[(Some(path), &|path| write_whole(path, page.as_bytes()))], quiet)?;
    }
    Ok(())
}

fn page(number: usize, text: &str, data: &Value) -> String {
    let before = link(number.checked_sub(1).map(|before| &LESSONS[before]), "Previous");
    let links = format!("{before}<a href=\"index.html\">All lessons</a>{}", link(LESSONS.get(number + 1), "Next"));
    let title = format!("{}. {}", number + 1, LESSONS[number].title);
    filled_in(&title, &with_numbers(text, data), &links, data)
}

fn link(other: Option<&Lesson>, name: &str) -> String {
    other.map_or(String::new(), |other| format!("<a href=\"{}\">{name}: {}</a>", other.file, other.title))
}

fn index() -> String {
    let text = include_str!("../../../assets/lessons/index.html");
    filled_in("Seven lessons in motion planning", text, "", &Value::Null)
}

fn filled_in(title: &str, text: &str, links: &str, data: &Value) -> String {
    TEMPLATE
        .replace("@TITLE@", &escaped_html(title))
        .replace("@STYLE@", &STYLES.concat())
        .replace("@SCRIPT@", SCRIPT)
        .replace("@LINKS@", links)
        .replace("@VERSION@", PROGRAM_VERSION)
        .replace("@TEXT@", text)
        // The last, so that nothing in it is replaced. No text of the data ends the element that it is in.
        .replace("@DATA@", &data.to_string().replace('<', "\\u003c"))
}

/// Returns a text in which `{{a.b}}` is the number `a.b` of the data.
///
/// # Panics
/// If the data have no such number: texts and data belong together.
fn with_numbers(text: &str, data: &Value) -> String {
    let mut parts = text.split("{{");
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once("}}").expect("a place in a text ends");
        let value = data.pointer(&format!("/{}", name.replace('.', "/")));
        let value = value.unwrap_or_else(|| panic!("the data of a lesson have no {name}"));
        filled += value.as_str().map_or_else(|| value.to_string(), str::to_owned).as_str();
        filled += rest;
    }
    filled
}

/// Returns the texts with the answers of each question in another order. Right answers, which texts have first, are in
/// each place equally often.
///
/// # Panics
/// If a question has not [`ANSWERS`] answers, each a line, of which the first is right.
fn with_shuffled_answers(texts: &[&str]) -> Vec<String> {
    let mut rng = rng::stream(1, "lessons/answers");
    let questions = texts.concat().matches("<button data-right").count();
    // The right answer has each place once in four questions, so nobody learns to click the first one.
    let mut places: Vec<usize> = (0..questions).map(|question| question % ANSWERS).collect();
    places.shuffle(&mut rng);
    let mut places = places.into_iter();
    let mut shuffled = Vec::new();
    for text in texts {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let firsts: Vec<usize> = (0..lines.len()).filter(|&at| lines[at].starts_with("<button data-right")).collect();
        for first in firsts {
            let answers = &mut lines[first..first + ANSWERS];
            assert!(answers.iter().all(|line| line.starts_with("<button")), "{answers:?}");
            // The last one also ends the question.
            let mut others: Vec<_> = answers.iter().map(|line| line.trim_end_matches("</li>").to_owned()).collect();
            let right = others.remove(0);
            others.shuffle(&mut rng);
            others.insert(places.next().expect("a place for each right answer"), right);
            others[ANSWERS - 1] += "</li>";
            answers.clone_from_slice(&others);
        }
        shuffled.push(lines.join("\n"));
    }
    shuffled
}

/// A number with a few decimals, so that pages stay small.
fn short(number: f64, decimals: usize) -> f64 {
    let scale: f64 = std::iter::repeat_n(10.0, decimals).product();
    (number * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn astar_with_an_admissible_estimate_costs_what_dijkstra_costs_and_weights_keep_their_bounds() {
        let data = grids::searches();
        for board in data["boards"].as_array().expect("boards") {
            let runs = board["runs"].as_array().expect("runs");
            let min = runs[0]["cost"].as_f64().expect("Dijkstra's search finds a path");
            for run in runs {
                let cost = run["cost"].as_f64().expect("a cost");
                let name = &run["name"];
                match run["bound"].as_f64() {
                    Some(bound) => assert!(cost <= bound * min + 0.001, "{name}: {cost} of {min}"),
                    None => assert!(cost >= min, "{name}"),
                }
            }
        }
    }

    #[test]
    fn texts_have_the_numbers_of_their_data() {
        let data = serde_json::json!({"a": {"b": 3}, "c": ["x"]});
        assert_eq!(with_numbers("{{a.b}} and {{c.0}}.", &data), "3 and x.");
        let lesson = &LESSONS[4];
        let page = page(4, lesson.text, &(lesson.data)().expect("curves"));
        assert!(LESSONS.iter().all(|lesson| index().contains(&format!(". {}</a>", lesson.title))), "the index has all");
        assert!(page.contains("href=\"4-sampling.html\"") && page.contains("href=\"6-intervals.html\""));
    }

    #[test]
    fn no_place_and_no_length_gives_a_right_answer_away() {
        let mut places = [0.0; ANSWERS];
        let mut longest = 0.0;
        let mut shortest = 0.0;
        for text in with_shuffled_answers(&LESSONS.map(|lesson| lesson.text)) {
            for question in text.split("<li>").skip(1).filter(|part| part.contains("data-right")) {
                let answers: Vec<&str> = question.split("<button").skip(1).collect();
                assert_eq!(answers.len(), ANSWERS, "{question}");
                let lengths: Vec<usize> = answers
                    .iter()
                    .map(|answer| answer.split_once("\">").and_then(|(_, rest)| rest.split_once('<')).expect("text").0)
                    .map(|text| text.chars().count())
                    .collect();
                let [min, max] = [lengths.iter().min(), lengths.iter().max()].map(|length| *length.expect("answers"));
                assert!(max <= min + min / 2 + 4, "{lengths:?}: {question}");
                let right = answers.iter().position(|answer| answer.starts_with(" data-right")).expect("a right one");
                places[right] += 1.0;
                longest += f64::from(lengths[right] == max);
                shortest += f64::from(lengths[right] == min);
            }
        }
        let questions: f64 = places.iter().sum();
        assert!(places.iter().all(|count| (0.2..=0.3).contains(&(count / questions))), "{places:?}");
        for extreme in [longest, shortest] {
            assert!(
                (0.1..=0.4).contains(&(extreme / questions)),
                "{longest} longest, {shortest} shortest of {questions}"
            );
        }
    }
}
