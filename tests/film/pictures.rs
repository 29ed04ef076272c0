//! Pictures of grid maps and of ways: what can be seen in them, whatever their shapes and values.

use std::fs;

use wildfire::geometry::{Cell, DVec2, FieldFrame, Pose};
use wildfire::grid::{Grid, Place};
use wildfire::picture::{
    ColourMap, CurveScene, DriveScene, DrivenWays, MapScene, Picture, Rgb, Zones, draw_curves, draw_drives, draw_map,
    draw_overlay, draw_surface,
};
use wildfire::planning::{Goal, GoalDisc};
use wildfire::vehicle::{Dimensions, Path, Segment};

const PAPER: Rgb = [255, 255, 255];
/// Ends of viridis.
const LOWEST: Rgb = [68, 1, 84];
const HIGHEST: Rgb = [253, 231, 37];
/// Nothing is drawn nearer to the edge of a picture than this, in pixels.
const MARGIN: u32 = 10;

fn pixels(picture: &Picture) -> impl Iterator<Item = (u32, u32, Rgb)> {
    let (width, height) = (picture.width(), picture.height());
    (0..height).flat_map(move |y| (0..width).map(move |x| (x, y, picture.pixel(x, y))))
}

fn count(picture: &Picture, colour: Rgb) -> usize {
    pixels(picture).filter(|&(_, _, pixel)| pixel == colour).count()
}

/// The middle of all pixels of a colour.
fn middle(picture: &Picture, colour: Rgb) -> (u32, u32) {
    let found: Vec<_> = pixels(picture).filter(|&(_, _, pixel)| pixel == colour).collect();
    assert!(!found.is_empty(), "no pixel is {colour:?}");
    let count = u32::try_from(found.len()).expect("pictures are small");
    (found.iter().map(|(x, _, _)| x).sum::<u32>() / count, found.iter().map(|(_, y, _)| y).sum::<u32>() / count)
}

fn is_dark_and_neutral([red, green, blue]: Rgb) -> bool {
    red.max(green).max(blue) < 80 && red.abs_diff(blue) < 12
}

fn draw_all(scene: &MapScene) -> [Picture; 3] {
    [draw_map(scene), draw_overlay(scene, None), draw_surface(scene)]
}

/// Two free cells above, an obstacle and a cell without value below.
fn four_cells() -> (Grid<bool>, impl Fn(Place) -> Option<f64>) {
    let occupied = Grid::from_values(2, 2, vec![false, false, true, false]);
    (occupied, |place| [[Some(3.0), Some(7.0)], [None, None]][place.0][place.1])
}

#[test]
fn cells_have_the_colours_of_their_values() {
    let (occupied, value) = four_cells();
    let picture = draw_map(&MapScene::new("Four cells", "value", &occupied, &value));
    let cell = 400 * 400;
    assert!(count(&picture, LOWEST) >= cell && count(&picture, HIGHEST) >= cell);
    let (low, high) = (middle(&picture, LOWEST), middle(&picture, HIGHEST));
    let beside = |x: u32, y: u32| picture.pixel(x, y);
    assert!(low.0 < high.0 && low.1.abs_diff(high.1) < 20, "the cells of the first row stand side by side");
    assert!(is_dark_and_neutral(beside(low.0, low.1 + 400)), "the obstacle stands below the lowest value");
    let [red, green, blue] = beside(high.0, high.1 + 400);
    assert!(red == green && red.abs_diff(blue) < 4 && red > 200 && red < 250, "a cell without value is light grey");
}

#[test]
fn the_same_scene_gives_the_same_pictures() {
    let (occupied, value) = four_cells();
    let scene = MapScene { goal: Some((0, 0)), ..MapScene::new("Twice", "value", &occupied, &value) };
    assert!(draw_all(&scene) == draw_all(&scene));
}

#[test]
fn path_and_marks_are_seen_on_every_colour() {
    let occupied = Grid::filled(12, 30, false);
    let value = |(_, col): Place| Some(col as f64);
    let path: Vec<Place> = (2..28).map(|col| (5, col)).collect();
    for colours in [ColourMap::Viridis, ColourMap::Jet] {
        let bare = MapScene { colours, ..MapScene::new("Ramp", "value", &occupied, &value) };
        let with_path = draw_map(&MapScene { path: &path, ..bare });
        let before = draw_map(&bare);
        let is_path = |&(x, _, pixel): &(u32, u32, Rgb)| x < 700 && pixel == [214, 0, 110];
        let row = pixels(&with_path).find(is_path).expect("the path has a colour").1 + 2;
        let mut seen = 0;
        for x in 0..700 {
            let (old, new) = (before.pixel(x, row), with_path.pixel(x, row));
            let distance: u32 = (0..3).map(|channel| u32::from(old[channel].abs_diff(new[channel]))).sum();
            seen += usize::from(distance > 100);
        }
        assert!(seen > 550, "{colours:?}: the path differs from its ground in {seen} pixels of 590");
        for mark in [
            MapScene { start: Some((2, 2)), ..bare },
            MapScene { goal: Some((2, 2)), ..bare },
            MapScene { stuck: Some((2, 2)), ..bare },
        ] {
            let marked = draw_map(&mark);
            let changed = pixels(&marked).filter(|&(x, y, pixel)| x < 700 && y < 350 && pixel != before.pixel(x, y));
            assert!(changed.count() > 100, "{colours:?}: a mark is hardly seen");
        }
    }
}

#[test]
fn nothing_is_cut_off_at_the_edges_whatever_the_shape() {
    for (rows, cols) in [(1, 1), (1, 500), (500, 1), (14, 20), (242, 242), (2, 5000), (5000, 2)] {
        let occupied = Grid::filled(rows, cols, false);
        let value = |(row, col): Place| Some((row + col) as f64);
        let corner = (rows - 1, cols - 1);
        let scene = MapScene {
            path: &[(0, 0), corner],
            start: Some((0, 0)),
            goal: Some(corner),
            stuck: Some((0, cols - 1)),
            ..MapScene::new("A rather long title, such as names of files are", "steps to the goal", &occupied, &value)
        };
        for (kind, picture) in ["map", "overlay", "surface"].into_iter().zip(draw_all(&scene)) {
            let (width, height) = (picture.width(), picture.height());
            let is_edge = |x: u32, y: u32| x.min(width - 1 - x).min(y).min(height - 1 - y) < MARGIN;
            let spoilt = pixels(&picture).find(|&(x, y, pixel)| is_edge(x, y) && pixel != PAPER);
            assert_eq!(spoilt, None, "{kind} of {rows} x {cols}, {width} x {height} pixels");
        }
    }
}

#[test]
fn maps_without_a_range_of_values_are_drawn() {
    let (free, full, empty) = (Grid::filled(3, 4, false), Grid::filled(3, 4, true), Grid::filled(0, 0, false));
    for value in [Some(5.0), Some(f64::INFINITY), Some(f64::NAN), None] {
        let value = move |_: Place| value;
        for occupied in [&free, &full, &empty] {
            for picture in draw_all(&MapScene::new("", "", occupied, &value)) {
                assert!(count(&picture, PAPER) > 1000);
            }
        }
    }
}

#[test]
fn jumps_are_seen_on_large_maps() {
    const SWEPT: Rgb = [190, 214, 240];
    let occupied = Grid::filled(900, 900, false);
    let mut swept = Grid::filled(900, 900, false);
    (100..800).for_each(|col| swept[(450, col)] = true);
    let value =
        |place: Place| (place == (450, 100) || place == (450, 799)).then_some(if place.1 == 100 { 0.0 } else { 1.0 });
    let bare = MapScene::new("Jumps", "cost", &occupied, &value);
    let (without, with) = (draw_map(&bare), draw_map(&MapScene { swept: Some(&swept), ..bare }));
    assert_eq!(count(&without, SWEPT), 0);
    assert!(count(&with, SWEPT) >= 690, "{} pixels", count(&with, SWEPT));
    for end in [0.0, 1.0].map(|share| ColourMap::Viridis.colour(share)) {
        let more = count(&with, end) - count(&without, end);
        assert!(more >= 12, "{more} pixels more of {end:?}");
    }
}

#[test]
fn infinite_values_have_the_colours_of_the_ends() {
    let occupied = Grid::filled(1, 4, false);
    let value = |(_, col): Place| Some([f64::NEG_INFINITY, 1.0, 2.0, f64::INFINITY][col]);
    let picture = draw_map(&MapScene::new("Infinite", "value", &occupied, &value));
    let two_cells = 2 * 200 * 200;
    assert!(count(&picture, LOWEST) >= two_cells && count(&picture, HIGHEST) >= two_cells);
}

#[test]
fn map_that_only_tells_what_is_free_has_a_key_in_place_of_the_bar() {
    let occupied = Grid::from_values(1, 2, vec![true, false]);
    let value = |place: Place| Some(f64::from(u8::from(occupied[place])));
    let with_bar = MapScene::new("Cells", "occupied", &occupied, &value);
    for (plain, with_bar) in draw_all(&MapScene { free_name: Some("free"), ..with_bar }).iter().zip(draw_all(&with_bar))
    {
        let coloured = |picture: &Picture| {
            pixels(picture)
                .filter(|(_, _, [red, green, blue])| red.max(green.max(blue)) - red.min(green.min(blue)) > 30)
                .count()
        };
        assert!(coloured(&with_bar) > 1000 && coloured(plain) == 0, "free cells have no colour of a value");
        assert!(pixels(plain).any(|(_, _, pixel)| is_dark_and_neutral(pixel)), "obstacles are dark");
    }
}

#[test]
fn overlays_show_zones_and_the_grey_beneath() {
    let occupied = Grid::from_values(1, 4, vec![true, false, false, false]);
    let grey = Grid::from_values(1, 4, vec![0, 90, 250, 250]);
    let value = |_: Place| Some(0.0);
    let zone = |(_, col): Place| usize::from(col == 3);
    let zones = Zones { names: &["near", "far"], zone: &zone };
    let scene = MapScene { zones: Some(zones), ..MapScene::new("Zones", "cost", &occupied, &value) };
    let picture = draw_overlay(&scene, Some(&grey));
    let mut colours: Vec<(Rgb, usize)> = Vec::new();
    for (_, _, pixel) in pixels(&picture).filter(|&(_, _, pixel)| pixel != PAPER) {
        match colours.iter_mut().find(|(colour, _)| *colour == pixel) {
            Some((_, count)) => *count += 1,
            None => colours.push((pixel, 1)),
        }
    }
    let cells: Vec<Rgb> =
        colours.into_iter().filter(|&(_, count)| count >= 190 * 190).map(|(colour, _)| colour).collect();
    let [obstacle, dark, light, far] = cells[..] else { panic!("four cells, four colours: {cells:?}") };
    assert!(is_dark_and_neutral(obstacle));
    assert!((0..3).all(|channel| dark[channel] < light[channel]), "the grey of the input shines through");
    assert!(light[1] + 20 < far[1], "zones have colours of their own");
}

#[test]
fn higher_values_stand_higher_in_surfaces() {
    let occupied = Grid::filled(9, 9, false);
    let hill = |(row, col): Place| Some(if row.abs_diff(4) + col.abs_diff(4) < 3 { 1.0 } else { 0.0 });
    let hollow = |place: Place| hill(place).map(|value| 1.0 - value);
    let goal_at = |value: &dyn Fn(Place) -> Option<f64>| {
        let scene = MapScene { goal: Some((4, 4)), ..MapScene::new("Surface", "value", &occupied, value) };
        let star = |&(x, _, pixel): &(u32, u32, Rgb)| x < 600 && pixel == [255, 214, 10];
        pixels(&draw_surface(&scene)).find(star).expect("marks are never hidden").1
    };
    let (hill, hollow) = (goal_at(&hill), goal_at(&hollow));
    assert!(hill + 100 < hollow, "the hill is drawn {hill} pixels from the top, the hollow {hollow}");
}

#[test]
fn walls_in_front_hide_what_lies_behind_them() {
    let occupied = Grid::from_values(12, 12, (0..144).map(|index| index / 12 == 0 || index / 12 == 5).collect());
    let seen = |wall: f64| {
        let levels = move |(row, _): Place| Some([40.0, 1.0, 1.0, 1.0, 0.0, wall, 1.0][row.min(6)]);
        let picture = draw_surface(&MapScene::new("Wall", "value", &occupied, &levels));
        pixels(&picture).filter(|&(x, _, pixel)| x < 700 && pixel == LOWEST).count()
    };
    let (open, walled) = (seen(0.0), seen(40.0));
    // At its eastern end the view passes beside the wall.
    assert!(open > 5000 && walled < open / 20, "{open} pixels are seen without the wall, {walled} behind it");
}

#[test]
fn paths_on_surfaces_are_dotted_where_they_are_hidden() {
    let occupied = Grid::from_values(12, 12, (0..144).map(|index| index / 12 == 0 || index / 12 == 5).collect());
    let path: Vec<Place> = (0..8).map(|col| (4, col)).collect();
    let seen = |wall: f64| {
        let levels = move |(row, _): Place| Some([40.0, 0.0, 0.0, 0.0, 0.0, wall, 0.0][row.min(6)]);
        let scene = MapScene { path: &path, ..MapScene::new("Path", "value", &occupied, &levels) };
        pixels(&draw_surface(&scene)).filter(|&(x, _, pixel)| x < 700 && pixel == [214, 0, 110]).count()
    };
    let (open, walled) = (seen(0.0), seen(40.0));
    assert!(open > 300 && (20..open / 2).contains(&walled), "{open} pixels in the open, {walled} behind the wall");
}

#[test]
fn png_files_hold_the_picture() {
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let path = folder.path().join("map.png");
    let (occupied, value) = four_cells();
    let picture = draw_map(&MapScene::new("Four cells", "value", &occupied, &value));
    picture.write_png(&path).expect("the folder takes files");
    let read = image::open(&path).expect("the file is a picture").to_rgb8();
    assert_eq!((read.width(), read.height()), (picture.width(), picture.height()));
    assert!(pixels(&picture).all(|(x, y, pixel)| read.get_pixel(x, y).0 == pixel));
    assert_eq!(fs::read_dir(folder.path()).expect("it is there").count(), 1, "nothing else is left in the folder");
    assert!(picture.write_png(&folder.path().join("no/such/folder.png")).is_err());
}

/// Colours of the first two ways.
const WAYS: [Rgb; 2] = [[214, 0, 110], [0, 114, 178]];

fn draw_way(segments: &[Segment], body: Option<&Dimensions>) -> Picture {
    let path = Path { start: Pose::default(), segments: segments.to_vec() };
    let scene =
        CurveScene { title: "A way", start: path.start, goal: path.end(), ways: &[("way", &path)], body, min_m: 1.0 };
    draw_curves(&scene)
}

#[test]
fn ways_turn_to_the_side_that_they_are_on() {
    let arc = |curvature| draw_way(&[Segment { curvature, length_m: 20.0 }], None);
    let (left, right) = (arc(0.1), arc(-0.1));
    // The key stands beside both at the same height, so the way itself makes the difference.
    assert!(middle(&left, WAYS[0]).0 > 100 && left.height() == right.height());
    assert!(middle(&left, WAYS[0]).1 > middle(&right, WAYS[0]).1, "the chord of a left turn lies above its arc");
}

#[test]
fn reverse_is_dashed() {
    let straight = |length_m| Segment { curvature: 0.0, length_m };
    let (forward, reverse) = (draw_way(&[straight(20.0)], None), draw_way(&[straight(-20.0)], None));
    let (whole, dashed) = (count(&forward, WAYS[0]), count(&reverse, WAYS[0]));
    assert!(dashed * 3 < whole * 2 && dashed * 3 > whole, "{dashed} pixels of {whole}");
}

#[test]
fn ways_that_coincide_are_both_seen_and_the_truck_is_outlined() {
    let path = Path { start: Pose::default(), segments: vec![Segment { curvature: 0.0, length_m: 30.0 }] };
    let bare = CurveScene {
        title: "Two ways",
        start: path.start,
        goal: path.end(),
        ways: &[("one", &path), ("other", &path)],
        body: None,
        min_m: 1.0,
    };
    let picture = draw_curves(&bare);
    assert!(WAYS.iter().all(|&colour| count(&picture, colour) > 600));
    let truck = Dimensions::default();
    let with_truck = draw_curves(&CurveScene { body: Some(&truck), ..bare });
    let dark = |picture: &Picture| pixels(picture).filter(|&(_, _, pixel)| is_dark_and_neutral(pixel)).count();
    assert!(dark(&with_truck) > dark(&picture) + 300);
}

fn drives<'a>(frame: FieldFrame, bushes: &'a [Cell], goals: &'a [(Goal, bool)], ways: &'a [DrivenWays]) -> Picture {
    let start = Pose::new(5.0, 5.0, 0.0);
    draw_drives(&DriveScene { title: "Drives", frame, bushes, start, goals, ways })
}

const OBSTACLE: Rgb = [56, 56, 60];

#[test]
fn bushes_cover_their_cells_without_seams() {
    // Seven cells on 720 pixels: edges fall between pixels.
    let frame = FieldFrame { cols: 7, rows: 7, cell_m: 5.0 };
    let bushes: Vec<Cell> = (2..7).flat_map(|col| (1..7).map(move |row| Cell { col, row })).collect();
    let picture = drives(frame, &bushes, &[], &[]);
    // From 205.71 to 720 pixels one way and 102.86 to 720 the other, and a square in the key.
    assert_eq!(count(&picture, OBSTACLE), (720 - 206) * (720 - 103) + 14 * 14);
}

#[test]
fn drives_goals_and_failures_are_seen_and_explained() {
    let frame = FieldFrame { cols: 20, rows: 10, cell_m: 5.0 };
    let goal = Goal::Pose(Pose::new(60.0, 40.0, 0.0));
    let disc = Goal::Disc(GoalDisc { centre: DVec2::new(80.0, 20.0), radius_m: 10.0 });
    let path = Path { start: Pose::new(5.0, 5.0, 0.0), segments: vec![Segment { curvature: 0.0, length_m: 50.0 }] };
    let ways = |paths| [DrivenWays { name: "one".into(), paths }];
    let bare = drives(frame, &[], &[], &ways(Vec::new()));
    let driven = drives(frame, &[], &[], &ways(vec![&path]));
    let ink = |picture: &Picture| pixels(picture).filter(|(.., colour)| is_dark_and_neutral(*colour)).count();
    // 50 m of 100 on 720 pixels, two wide.
    assert!((600..800).contains(&(count(&driven, [214, 0, 110]) - count(&bare, [214, 0, 110]))));
    for goal in [goal, disc] {
        let (reached, missed) = (drives(frame, &[], &[(goal, true)], &[]), drives(frame, &[], &[(goal, false)], &[]));
        assert!(ink(&reached) > ink(&drives(frame, &[], &[], &[])) && ink(&missed) > ink(&reached));
    }
}

#[test]
fn what_lies_outside_of_the_field_is_left_out() {
    let frame = FieldFrame { cols: 1, rows: 200, cell_m: 0.5 };
    let places = [(-50.0, 5.0), (f64::NAN, 5.0), (1e6, -1e6)];
    let poses = places.map(|(x, y)| (Goal::Pose(Pose::new(x, y, 1.0)), true));
    let key = drives(frame, &[], &[(Goal::Pose(Pose::new(f64::NAN, 0.0, 0.0)), true)], &[]);
    assert_eq!(drives(frame, &[], &poses, &[]), key);
    let discs = places.map(|(x, y)| (Goal::Disc(GoalDisc { centre: DVec2::new(x, y), radius_m: 1e6 }), true));
    assert!(drives(frame, &[], &discs, &[]).width() < 600);
}
