//! The colours of a film: at most 255, and the nearest of them to any colour.

use crate::colours::Rgb;

/// The palette's place of what shows the frame before.
pub const TRANSPARENT: u8 = 0;

/// The most colours of a palette.
const MAX_COLOURS: usize = 255;

/// One for each colour of three bytes.
const COLOURS: usize = 1 << 24;

/// The frequencies of colours in a film.
pub struct ColourCounts {
    counts: Vec<u32>,
}

/// At most 255 colours; their places count from 1.
pub struct Palette {
    colours: Vec<Rgb>,
    /// The place of the colour that is nearest to each colour, [`TRANSPARENT`] where that is not known yet.
    nearest: Vec<u8>,
}

impl Default for ColourCounts {
    fn default() -> Self {
        Self { counts: vec![0; COLOURS] }
    }
}

impl ColourCounts {
    /// Counts the pixels of a frame: red, green, blue and opacity, which is not looked at.
    pub fn add(&mut self, pixels: &[u8]) {
        let (pixels, _) = pixels.as_chunks::<4>();
        for &[red, green, blue, _] in pixels {
            let count = &mut self.counts[number([red, green, blue])];
            *count = count.saturating_add(1);
        }
    }

    /// The colours themselves if there are at most 255 of them, else 255 that stand for all.
    pub fn palette(&self) -> Palette {
        let counted = self.counts.iter().enumerate().filter(|&(_, &count)| count > 0);
        let colours = counted.map(|(number, &count)| Weighted { colour: colour(number), weight: weight(count) });
        let groups = split(colours.collect());
        Palette::new(groups.iter().map(ColourGroup::representative).collect())
    }
}

impl Palette {
    fn new(colours: Vec<Rgb>) -> Self {
        let mut nearest = vec![TRANSPARENT; COLOURS];
        for (place, &colour) in (1..=u8::MAX).zip(&colours) {
            nearest[number(colour)] = place;
        }
        Self { colours, nearest }
    }

    /// Red, green and blue of all places.
    pub fn table(&self) -> Vec<u8> {
        let transparent = [0; 3];
        [transparent].iter().chain(&self.colours).flatten().copied().collect()
    }

    /// The place of the colour that is nearest to `colour`, the first of several.
    pub fn nearest(&mut self, colour: Rgb) -> u8 {
        let cached = self.nearest[number(colour)];
        if cached != TRANSPARENT {
            return cached;
        }
        // Asked once for each colour of the film: a frame repeats those of the frames before.
        let places = (1..=u8::MAX).zip(&self.colours).min_by_key(|&(_, &other)| squared_distance(colour, other));
        let place = places.map_or(TRANSPARENT, |(place, _)| place);
        self.nearest[number(colour)] = place;
        place
    }
}

fn number([red, green, blue]: Rgb) -> usize {
    usize::from(red) << 16 | usize::from(green) << 8 | usize::from(blue)
}

fn colour(number: usize) -> Rgb {
    [16, 8, 0].map(|shift| (number >> shift & 0xff) as u8)
}

fn squared_distance(one: Rgb, other: Rgb) -> u32 {
    one.iter().zip(other).map(|(&one, other)| u32::from(one.abs_diff(other))).map(|apart| apart * apart).sum()
}

/// The square root, so that what is small in the picture keeps its colours too.
fn weight(count: u32) -> u64 {
    u64::from(count.isqrt())
}

#[derive(Clone, Copy)]
struct Weighted {
    colour: Rgb,
    weight: u64,
}

/// Colours that share a place.
struct ColourGroup {
    members: Vec<Weighted>,
    /// The channel in which they differ most, and by how much: the weighted sum of squared differences from the mean.
    widest: (usize, f64),
}

impl ColourGroup {
    fn new(members: Vec<Weighted>) -> Self {
        let spreads = [0, 1, 2].map(|channel| (channel, spread(&members, channel)));
        let widest = spreads.into_iter().reduce(|max, other| if other.1 > max.1 { other } else { max });
        Self { members, widest: widest.expect("there are three channels") }
    }

    /// Parts it at the mean of the channel in which its colours differ most; both halves have members, since colours
    /// that differ lie on both sides of their mean.
    fn halves(self) -> [Self; 2] {
        let channel = self.widest.0;
        let mean = mean(&self.members, channel);
        let (low, high) = self.members.into_iter().partition(|member| f64::from(member.colour[channel]) <= mean);
        [Self::new(low), Self::new(high)]
    }

    /// The colour that has more than half of the weight, or else the mean: plain areas keep their colour.
    fn representative(&self) -> Rgb {
        let total: u64 = self.members.iter().map(|member| member.weight).sum();
        let heaviest = self.members.iter().find(|member| 2 * member.weight > total);
        heaviest.map_or_else(|| [0, 1, 2].map(|channel| mean(&self.members, channel).round() as u8), |one| one.colour)
    }
}

/// Splits colours into groups of alike ones, at most [`MAX_COLOURS`].
///
/// The group whose colours differ most is parted, again and again, so that each cut takes off as much of the error as
/// one cut can. (Wan, Wong and Prusinkiewicz, "An Algorithm for Multidimensional Data Clustering", 1988, section 3.)
fn split(colours: Vec<Weighted>) -> Vec<ColourGroup> {
    let mut groups = if colours.is_empty() { Vec::new() } else { vec![ColourGroup::new(colours)] };
    while groups.len() < MAX_COLOURS {
        let widest = (0..groups.len()).max_by(|&one, &other| groups[one].widest.1.total_cmp(&groups[other].widest.1));
        let Some(widest) = widest.filter(|&widest| groups[widest].widest.1 > 0.0) else { break };
        // Of equals the last one is parted; the order of groups decides nothing else but places in the palette.
        let halves = groups.swap_remove(widest).halves();
        groups.extend(halves);
    }
    groups
}

fn mean(members: &[Weighted], channel: usize) -> f64 {
    let (mut sum, mut weight) = (0, 0);
    for member in members {
        sum += member.weight * u64::from(member.colour[channel]);
        weight += member.weight;
    }
    sum as f64 / weight as f64
}

fn spread(members: &[Weighted], channel: usize) -> f64 {
    let mean = mean(members, channel);
    let difference = |member: &Weighted| f64::from(member.colour[channel]) - mean;
    members.iter().map(|member| member.weight as f64 * difference(member) * difference(member)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(pixels: &[Rgb]) -> ColourCounts {
        let mut counts = ColourCounts::default();
        for &[red, green, blue] in pixels {
            counts.add(&[red, green, blue, 255]);
        }
        counts
    }

    #[test]
    fn few_colours_are_kept_exactly() {
        let colours: Vec<Rgb> = (0..255).map(|number| [number, number / 2, 7 * (number % 30)]).collect();
        let mut palette = counted(&colours).palette();
        assert_eq!(palette.table().len(), 3 * 256);
        let table = palette.table();
        for &colour in &colours {
            let place = usize::from(palette.nearest(colour));
            assert_eq!(table[3 * place..][..3], colour);
        }
    }

    #[test]
    fn many_colours_are_distinguished_by_what_is_nearest() {
        let colours: Vec<Rgb> =
            (0..4096).map(|number: u32| [1, 16, 256].map(|unit| (number / unit % 16 * 16) as u8)).collect();
        let mut palette = counted(&colours).palette();
        assert_eq!(palette.colours.len(), MAX_COLOURS);
        for &colour in &colours {
            let place = palette.nearest(colour);
            let distance = squared_distance(colour, palette.colours[usize::from(place) - 1]);
            let best = palette.colours.iter().map(|&other| squared_distance(colour, other)).min();
            assert_eq!(Some(distance), best);
            assert_eq!(palette.nearest(colour), place, "it is remembered otherwise");
            assert!(distance <= 3 * 32 * 32, "{colour:?} is {distance} away");
        }
    }

    #[test]
    fn plain_areas_keep_their_colour_whatever_surrounds_them() {
        let (plain, rare): (Rgb, Vec<Rgb>) = (
            [250, 251, 252],
            (0..20_000_u32).map(|number| [17, 31, 97].map(|step| (number * step % 251) as u8)).collect(),
        );
        let mut counts = counted(&rare);
        for _ in 0..1_000_000 {
            counts.add(&[plain[0], plain[1], plain[2], 255]);
        }
        let mut palette = counts.palette();
        let place = usize::from(palette.nearest(plain));
        assert_eq!(palette.colours[place - 1], plain);
    }
}
