//! What a closest-point query has put off.

/// Children that a query has put off; more than this go to the heap.
const STACK: usize = 64;

/// A child and a lower bound of its squared distance, in one word that sorts by distance.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry(u64);

impl Entry {
    #[inline(always)]
    pub(super) fn new(distance: f32, child: u32) -> Self {
        Self((u64::from(distance.to_bits()) << 32) | u64::from(child))
    }

    #[inline(always)]
    pub(super) fn distance(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    #[inline(always)]
    pub(super) fn child(self) -> u32 {
        self.0 as u32
    }
}

#[inline(always)]
pub(super) fn sort_down([a, b, c, d]: [Entry; 4]) -> [Entry; 4] {
    let (a, b) = (a.max(b), a.min(b));
    let (c, d) = (c.max(d), c.min(d));
    let (a, c) = (a.max(c), a.min(c));
    let (b, d) = (b.max(d), b.min(d));
    let (b, c) = (b.max(c), b.min(c));
    [a, b, c, d]
}

/// Children put off, on the machine's stack as long as they fit.
pub(super) struct Stack {
    entries: [Entry; STACK],
    len: usize,
    overflow: Vec<Entry>,
}

impl Stack {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            entries: [Entry(0); STACK],
            len: 0,
            overflow: Vec::new(),
        }
    }

    /// Puts off those of four children that are within `reach`, in their order.
    #[inline(always)]
    pub(super) fn push_within(&mut self, children: [Entry; 4], reach: f32) {
        if self.len + children.len() > STACK {
            let within = children.into_iter().filter(|e| e.distance() <= reach);
            return self.overflow.extend(within);
        }
        for entry in children {
            // Written in any case, kept if near: there is no branch to be guessed.
            self.entries[self.len] = entry;
            self.len += usize::from(entry.distance() <= reach);
        }
    }

    /// The last child put off that is within `reach`; those before it that are not are dropped.
    #[inline(always)]
    pub(super) fn pop_within(&mut self, reach: f32) -> Option<u32> {
        while let Some(entry) = self.overflow.pop() {
            if entry.distance() <= reach {
                return Some(entry.child());
            }
        }
        while self.len > 0 {
            self.len -= 1;
            let entry = self.entries[self.len];
            if entry.distance() <= reach {
                return Some(entry.child());
            }
        }
        None
    }
}
