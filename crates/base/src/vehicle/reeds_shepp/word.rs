//! The 48 words of Reeds and Shepp, the four loops of Dubins, and how the symmetries act on them.

use std::fmt;

use crate::vehicle::curve::chord::Symmetry;
use crate::vehicle::curve::{Gear, Letter, Letters, MAX_LETTERS, Steering};

/// The paper's families: C is an arc, S a straight, | a cusp. Arcs marked `u` are equally long; before or after a straight,
/// an arc at a cusp is a quarter turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// CSC.
    Csc,
    /// CCC, of [`Word::LOOPS`].
    Ccc,
    /// C|C|C.
    CCuspCCuspC,
    /// C|CC.
    CCuspCc,
    /// CC|C.
    CcCuspC,
    /// CCu|CuC.
    CcCuspCc,
    /// C|CuCu|C.
    CCuspCcCuspC,
    /// C|CSC.
    CCuspCsc,
    /// CSC|C.
    CscCuspC,
    /// C|CSC|C.
    CCuspCscCuspC,
}

/// In the notation of the paper, as in `CC|CC`.
impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Csc => "CSC",
            Self::Ccc => "CCC",
            Self::CCuspCCuspC => "C|C|C",
            Self::CCuspCc => "C|CC",
            Self::CcCuspC => "CC|C",
            Self::CcCuspCc => "CC|CC",
            Self::CCuspCcCuspC => "C|CC|C",
            Self::CCuspCsc => "C|CSC",
            Self::CscCuspC => "CSC|C",
            Self::CCuspCscCuspC => "C|CSC|C",
        })
    }
}

/// The words that start forward and to the left; the other 39 are their images under reflection and time flip.
///
/// A name is the word's letters, with `p` for + and `m` for -.
#[expect(clippy::enum_variant_names, reason = "a name is a whole word, and all of them start to the left and forward")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WordForm {
    LpSpLp,
    LpSpRp,
    LpRmLm,
    LpRpLm,
    LpRpLmRm,
    LpRmSmLm,
    LpSpRpLm,
    LpRmSmRm,
    LpSpLpRm,
    LpRmLp,
    LpRmLmRp,
    LpRmSmLmRp,
    LpRpLp,
}

// Fewer cusps first: the search for the cheapest curve ends at the first word that has too many.
crate::names! { WordForm {
    LpSpLp: "L+S+L+",
    LpSpRp: "L+S+R+",
    LpRmLm: "L+R-L-",
    LpRpLm: "L+R+L-",
    LpRpLmRm: "L+R+L-R-",
    LpRmSmLm: "L+R-S-L-",
    LpSpRpLm: "L+S+R+L-",
    LpRmSmRm: "L+R-S-R-",
    LpSpLpRm: "L+S+L+R-",
    LpRmLp: "L+R-L+",
    LpRmLmRp: "L+R-L-R+",
    LpRmSmLmRp: "L+R-S-L-R+",
    LpRpLp: "L+R+L+",
} }

impl WordForm {
    pub const fn len(self) -> usize {
        self.name().len() / 2
    }

    /// The letters, and meaningless ones after the last.
    const fn read_letters(self) -> [Letter; MAX_LETTERS] {
        let spelling = self.name().as_bytes();
        let mut letters = [Letter { steering: Steering::Straight, gear: Gear::Forward }; MAX_LETTERS];
        let mut index = 0;
        while index < self.len() {
            letters[index].steering = match spelling[2 * index] {
                b'L' => Steering::Left,
                b'S' => Steering::Straight,
                _ => Steering::Right,
            };
            letters[index].gear = if spelling[2 * index + 1] == b'+' { Gear::Forward } else { Gear::Reverse };
            index += 1;
        }
        letters
    }

    fn letters(self) -> &'static [Letter] {
        &LETTERS[self as usize][..self.len()]
    }

    /// Returns the form of which the letters in the opposite order are an image.
    const fn backwards(self) -> Self {
        match self {
            Self::LpRmLm => Self::LpRpLm,
            Self::LpRpLm => Self::LpRmLm,
            Self::LpRmSmLm => Self::LpSpRpLm,
            Self::LpSpRpLm => Self::LpRmSmLm,
            Self::LpRmSmRm => Self::LpSpLpRm,
            Self::LpSpLpRm => Self::LpRmSmRm,
            symmetric => symmetric,
        }
    }
}

static LETTERS: [[Letter; MAX_LETTERS]; 13] = {
    let mut letters = [WordForm::LpSpLp.read_letters(); 13];
    let mut index = 0;
    while index < letters.len() {
        letters[index] = WordForm::ALL[index].read_letters();
        index += 1;
    }
    letters
};

/// A way between two poses by one of the words.
pub type Curve = crate::vehicle::curve::Curve<Word>;

/// One of the 48 words of Reeds and Shepp, or of [`Word::LOOPS`], printed as in `L+S+R-`: left, straight or right, forward or in reverse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    pub(super) form: WordForm,
    /// Starts to the right.
    pub(super) reflected: bool,
    /// Starts in reverse.
    pub(super) flipped: bool,
}

impl Word {
    /// Every word of Reeds and Shepp once, in the order that decides between equals.
    pub const ALL: [Self; 48] = {
        let mut words = [Self::new(WordForm::LpSpLp, false, false); 48];
        let mut index = 0;
        while index < words.len() {
            words[index] = Self::new(WordForm::ALL[index / 4], index & 1 != 0, index & 2 != 0);
            index += 1;
        }
        words
    };

    /// The words without a cusp that only Dubins needs: an inner arc of more than half a turn. With its longer part driven
    /// the other way round, each is a shorter word with two cusps.
    pub const LOOPS: [Self; 4] = [
        Self::new(WordForm::LpRpLp, false, false),
        Self::new(WordForm::LpRpLp, true, false),
        Self::new(WordForm::LpRpLp, false, true),
        Self::new(WordForm::LpRpLp, true, true),
    ];

    pub(super) const fn new(form: WordForm, reflected: bool, flipped: bool) -> Self {
        Self { form, reflected, flipped }
    }

    pub fn family(self) -> Family {
        match self.form {
            WordForm::LpSpLp | WordForm::LpSpRp => Family::Csc,
            WordForm::LpRpLp => Family::Ccc,
            WordForm::LpRmLp => Family::CCuspCCuspC,
            WordForm::LpRmLm => Family::CCuspCc,
            WordForm::LpRpLm => Family::CcCuspC,
            WordForm::LpRpLmRm => Family::CcCuspCc,
            WordForm::LpRmLmRp => Family::CCuspCcCuspC,
            WordForm::LpRmSmLm | WordForm::LpRmSmRm => Family::CCuspCsc,
            WordForm::LpSpRpLm | WordForm::LpSpLpRm => Family::CscCuspC,
            WordForm::LpRmSmLmRp => Family::CCuspCscCuspC,
        }
    }

    /// Changes between forward and reverse, when no letter is of length 0.
    pub const fn cusps(self) -> u32 {
        match self.form {
            WordForm::LpSpLp | WordForm::LpSpRp | WordForm::LpRpLp => 0,
            WordForm::LpRmLm | WordForm::LpRpLm | WordForm::LpRpLmRm => 1,
            WordForm::LpRmSmLm | WordForm::LpRmSmRm | WordForm::LpSpRpLm | WordForm::LpSpLpRm => 1,
            WordForm::LpRmLp | WordForm::LpRmLmRp | WordForm::LpRmSmLmRp => 2,
        }
    }

    /// Place of the word in [`Word::ALL`], followed by [`Word::LOOPS`].
    pub(super) fn rank(self) -> usize {
        4 * self.form as usize + 2 * usize::from(self.flipped) + usize::from(self.reflected)
    }

    /// The image of the word under the symmetries.
    pub(super) fn under(self, symmetry: Symmetry) -> Self {
        let word = if symmetry.backwards { self.backwards() } else { self };
        Self {
            form: word.form,
            reflected: word.reflected != symmetry.reflected,
            flipped: word.flipped != symmetry.flipped,
        }
    }

    fn backwards(self) -> Self {
        let last = self.form.letters()[self.form.len() - 1];
        Self {
            form: self.form.backwards(),
            reflected: self.reflected != (last.steering == Steering::Right),
            flipped: self.flipped != (last.gear == Gear::Reverse),
        }
    }
}

impl Letters for Word {
    fn letters(&self) -> impl Iterator<Item = Letter> + Clone {
        let Self { form, reflected, flipped } = *self;
        form.letters().iter().map(move |&letter| {
            let letter = if reflected { letter.reflected() } else { letter };
            if flipped { letter.flipped() } else { letter }
        })
    }
}

impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.letters().try_for_each(|letter| letter.fmt(f))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_48_words_differ_and_know_their_place() {
        let spellings: BTreeSet<String> = Word::ALL.iter().map(Word::to_string).collect();
        assert_eq!(spellings.len(), 48);
        for (place, word) in Word::ALL.iter().chain(&Word::LOOPS).enumerate() {
            assert_eq!(word.rank(), place, "{word}");
        }
        assert!(Word::ALL.is_sorted_by_key(|word| word.cusps()));
    }

    /// A family's notation can be read off the letters.
    #[test]
    fn families_and_cusps_are_those_of_the_letters() {
        for word in Word::ALL.into_iter().chain(Word::LOOPS) {
            let mut notation = String::new();
            let mut gear = None;
            for letter in word.letters() {
                if gear.is_some_and(|before| before != letter.gear) {
                    notation.push('|');
                }
                gear = Some(letter.gear);
                notation.push(if letter.steering == Steering::Straight { 'S' } else { 'C' });
            }
            assert_eq!(word.family().to_string(), notation, "{word}");
            assert_eq!(word.cusps() as usize, notation.matches('|').count(), "{word}");
        }
    }

    #[test]
    fn symmetries_do_to_words_what_they_do_to_letters() {
        for word in Word::ALL.into_iter().chain(Word::LOOPS) {
            let image = |flipped, reflected, backwards| word.under(Symmetry { flipped, reflected, backwards });
            let letters: Vec<Letter> = word.letters().collect();
            let flipped: Vec<Letter> = image(true, false, false).letters().collect();
            let reflected: Vec<Letter> = image(false, true, false).letters().collect();
            let mut backwards: Vec<Letter> = image(false, false, true).letters().collect();
            backwards.reverse();
            assert_eq!(flipped, letters.iter().map(|letter| letter.flipped()).collect::<Vec<_>>());
            assert_eq!(reflected, letters.iter().map(|letter| letter.reflected()).collect::<Vec<_>>());
            assert_eq!(backwards, letters);
        }
    }
}
