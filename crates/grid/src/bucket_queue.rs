//! The open list of a best-first search whose priorities never decrease.

/// The width of a bucket.
pub const WIDTH: f64 = 0.5;

/// Buckets in use at one time.
const RING: usize = 8;

/// The greatest difference between a new priority and the last one taken.
pub const REACH: f64 = WIDTH * (RING - 2) as f64;

/// A priority queue that returns the smallest priority first and, among equals, the latest entry.
///
/// A priority must be equal to the last one handed out, or at least [`WIDTH`] and at most [`REACH`] above it. Then
/// entries can be put into buckets as they come, and a bucket sorted when its turn comes: what still joins it is
/// equal to its smallest. After Denardo and Fox, "Shortest-route methods: 1. Reaching, pruning, and buckets"
/// (Operations Research 27, 1979), whose buckets are as wide as the shortest arc.
pub struct BucketQueue<T> {
    buckets: [Vec<(f64, T)>; RING],
    /// Number of the bucket in turn, which is sorted with the smallest at its end.
    turn: usize,
    len: usize,
}

impl<T> BucketQueue<T> {
    /// Creates a queue with its first entry, whose priority is not negative.
    pub fn new(priority: f64, entry: T) -> Self {
        let mut queue = Self { buckets: Default::default(), turn: bucket(priority), len: 0 };
        queue.push(priority, entry);
        queue
    }

    pub fn push(&mut self, priority: f64, entry: T) {
        let bucket = bucket(priority);
        debug_assert!((self.turn..self.turn + RING).contains(&bucket), "{priority} is out of turn");
        self.buckets[bucket % RING].push((priority, entry));
        self.len += 1;
    }

    pub fn pop(&mut self) -> Option<(f64, T)> {
        if self.len == 0 {
            return None;
        }
        while self.buckets[self.turn % RING].is_empty() {
            self.turn += 1;
            let next = &mut self.buckets[self.turn % RING];
            next.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        }
        self.len -= 1;
        self.buckets[self.turn % RING].pop()
    }
}

fn bucket(priority: f64) -> usize {
    (priority / WIDTH) as usize
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;

    #[test]
    fn entries_come_in_the_order_of_their_priorities() {
        let mut rng = wildfire_base::rng::stream(1, "bucket queue test");
        let mut queue = BucketQueue::new(1000.25, 0);
        let mut pushed = vec![1000.25];
        let mut popped = Vec::new();
        while let Some((priority, number)) = queue.pop() {
            assert_eq!(priority, pushed[number]);
            popped.push(priority);
            for _ in 0..rng.random_range(0..4).min(3000 - pushed.len()) {
                let rise = if rng.random_bool(0.3) { 0.0 } else { rng.random_range(WIDTH..=REACH) };
                queue.push(priority + rise, pushed.len());
                pushed.push(priority + rise);
            }
        }
        assert!(popped.is_sorted());
        assert_eq!(popped.len(), pushed.len());
        assert!(popped.len() > 100, "the queue ran empty early");
    }

    #[test]
    fn of_equals_the_latest_comes_first() {
        let mut queue = BucketQueue::new(7.0, 'a');
        assert_eq!(queue.pop(), Some((7.0, 'a')));
        queue.push(7.0, 'b');
        queue.push(7.5, 'd');
        queue.push(7.0, 'c');
        let order: Vec<char> = std::iter::from_fn(|| queue.pop()).map(|(_, entry)| entry).collect();
        assert_eq!(order, ['c', 'b', 'd']);
    }
}
