//! The language of a chart: its words, and the sign in its decimal numbers.

/// The languages in which charts are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Language {
    #[default]
    English,
    German,
}

/// Words of a chart in every language. `{}` stands for what they are filled with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Words {
    pub english: &'static str,
    pub german: &'static str,
}

/// The title of one of several sheets: the title, the sheet's number, and how many there are.
pub const ONE_OF_SEVERAL: Words = Words::new("{} ({} of {})", "{} ({} von {})");
/// What is said instead of a distribution without values.
pub const NO_VALUE: Words = Words::new("no run has it", "kein Lauf hat einen Wert");

impl Words {
    pub const fn new(english: &'static str, german: &'static str) -> Self {
        Self { english, german }
    }

    pub const fn in_language(self, language: Language) -> &'static str {
        match language {
            Language::English => self.english,
            Language::German => self.german,
        }
    }

    /// Puts texts in the places of `{}`, one after the other.
    pub fn filled(self, language: Language, texts: &[&str]) -> String {
        let mut parts = self.in_language(language).split("{}");
        let mut filled = parts.next().unwrap_or_default().to_owned();
        for (text, part) in texts.iter().zip(parts) {
            filled.push_str(text);
            filled.push_str(part);
        }
        filled
    }
}

impl Language {
    /// Writes a number as the language does, which has a point where English has one.
    pub fn number(self, text: &str) -> String {
        match self {
            Self::English => text.to_owned(),
            Self::German => text.replace('.', ","),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_filled_in_their_order_and_what_fills_them_is_left_as_it_is() {
        assert_eq!(ONE_OF_SEVERAL.filled(Language::English, &["a {} b", "1", "3"]), "a {} b (1 of 3)");
        assert_eq!(ONE_OF_SEVERAL.filled(Language::German, &["a", "1", "3"]), "a (1 von 3)");
    }

    #[test]
    fn german_numbers_have_a_comma() {
        let written = |language: Language| ["0.25", "1e-7", "12"].map(|number| language.number(number));
        assert_eq!(written(Language::English), ["0.25", "1e-7", "12"]);
        assert_eq!(written(Language::German), ["0,25", "1e-7", "12"]);
    }
}
