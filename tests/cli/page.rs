//! Pages that compute runs, and games that come from them.

use crate::story::Story;

/// The first bytes of every module.
const MODULE: &str = "\0asm\x01\0\0\0";

/// A game in which the Wumpus waits when it is asked first, and whose player left then.
const GAME: &str = r#"{"wildfire_game": 1, "scenario": {"name": "smoke"}, "seed": 3, "plays": ["wumpus"],
    "answers": [{"t_ns": 0, "side": "wumpus", "number": 0, "choice": "wait"}]}"#;

#[test]
fn a_page_carries_the_module_and_what_it_begins_with() {
    let story = Story::begin();
    story.file("m.wasm", MODULE);
    story.file("game.json", GAME);
    story
        .tell(&["page", "fleet", "--seed", "9", "--side", "unimog", "--module", "m.wasm", "-o", "p.html"])
        .expect_code(0);
    let page = story.read("p.html");
    assert!(page.contains(r#""scenario":{"name":"fleet"},"seed":9,"plays":["unimog"]"#));
    assert!(page.contains(r#"id="module""#));
    for place in ["@POLICY@", "@DESK@", "@QUESTION@", "@DATA@", "@TITLE@", "@SCRIPT@"] {
        assert!(!page.contains(place), "{place} is not filled in");
    }
    story.tell(&["page", "--game", "game.json", "--module", "m.wasm", "-o", "g.html"]).expect_code(0);
    assert!(story.read("g.html").contains(r#""choice":"wait""#));
}

#[test]
fn what_cannot_be_a_page_is_refused() {
    let story = Story::begin();
    story.file("m.wasm", MODULE);
    story.file("text.wasm", "(module)");
    story.file("game.json", &GAME.replace("game\": 1", "game\": 7"));
    story.file("wrong.toml", "[fires]\n");
    for (words, sentence) in [
        (&["page", "-o", "p.html"][..], "there is no module beside the program"),
        (&["page", "-o", "p.html", "--module", "gone.wasm"], "gone.wasm: it cannot be read"),
        (&["page", "-o", "p.html", "--module", "text.wasm"], "text.wasm: it is no WebAssembly module"),
        (&["page", "-o", "p.png", "--module", "m.wasm"], "p.png would hold a page"),
        (&["page", "nowhere", "-o", "p.html", "--module", "m.wasm"], "nor a built-in scenario `nowhere`"),
        (&["page", "wrong.toml", "-o", "p.html", "--module", "m.wasm"], "unknown field `fires`"),
        (&["page", "--game", "game.json", "-o", "p.html", "--module", "m.wasm"], "the game has format 7; expected 1"),
        (&["run", "--answers", "game.json"], "the game has format 7; expected 1"),
        (&["run", "--answers", "m.wasm"], "m.wasm"),
        (&["run", "dense", "--answers", "game.json"], "cannot be used with"),
    ] {
        let answer = story.tell(words).expect_code(2);
        assert!(answer.stderr.contains(sentence), "{words:?}: {}", answer.stderr);
    }
    assert!(!story.path("p.html").exists() && !story.path("p.png").exists());
}

#[test]
fn a_game_that_does_not_go_to_its_end_is_no_run() {
    let story = Story::begin();
    story.file("game.json", GAME);
    let answer = story.tell(&["run", "--answers", "game.json", "--out", "run.wildfire"]).expect_code(2);
    assert!(answer.stderr.contains("wumpus/0 is asked at"), "{}", answer.stderr);
    assert!(answer.stderr.contains("there are 1 answers"), "{}", answer.stderr);
    assert!(!story.path("run.wildfire").exists());
}
