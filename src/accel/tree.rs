//! Binned SAH builder of binary trees: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies" (2007), in parallel.
//!
//! One builder serves both levels: a mesh's tree, built once on all cores, and the top level, rebuilt every frame in the same memory.
//!
//! *Depth.* The shader's stack is an array of fixed length, so no path may hold more than `max_depth` inner nodes. A node of n items
//! at depth d keeps d + ceil(log2 n) <= max_depth: a split by the surface area heuristic is taken only where both sides keep to it,
//! and a split in equal halves always does, since ceil(log2 ceil(n / 2)) = ceil(log2 n) - 1 for n >= 2.

use super::bounds::Aabb;
use crate::shared::{BVH_COUNT_SHIFT, BVH_EMPTY, BVH_LEAF, BvhNode};
use glam::Vec3A;

/// Ranges of fewer items are built by one thread.
const SERIAL: usize = 4096;
const BINS: usize = 16;
/// Cost of visiting an inner node in triangle tests.
const NODE_COST: f32 = 1.0;

/// What the tree is for.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Most items of one leaf, 1 to 4. With 1, a leaf names its item's own index instead of its place in the order.
    pub leaf: usize,
    /// Most inner nodes on a way from the root to a leaf, at least ceil(log2(items)).
    pub depth: u32,
}

/// A box to put into a tree, and what it is the box of.
#[derive(Debug, Clone, Copy)]
pub struct Item {
    pub bounds: Aabb,
    pub index: u32,
}

/// A tree, and the memory to build the next one in.
#[derive(Debug, Clone, Default)]
pub struct Tree {
    /// A parent comes before its children.
    pub nodes: Vec<BvhNode>,
    /// As a child of a node: see [`BvhNode`].
    pub root: u32,
}

impl Tree {
    /// Builds on all threads and puts `items` into the order of the leaves.
    pub fn build(items: &mut [Item], limits: Limits) -> Self {
        if items.is_empty() {
            return Self { nodes: Vec::new(), root: BVH_EMPTY };
        }
        let range = Range::of(items);
        let mut nodes = Vec::with_capacity(items.len() / 2);
        let root = build_parallel(items, range, Place { first: 0, depth: 0 }, limits).append_to(&mut nodes);
        Self { nodes, root }
    }

    /// Builds on this thread without allocating, once `nodes` has grown to its size.
    pub fn rebuild(&mut self, items: &mut [Item], limits: Limits) {
        self.nodes.clear();
        self.root = match items.is_empty() {
            true => BVH_EMPTY,
            false => build_serial(items, Range::of(items), Place { first: 0, depth: 0 }, limits, &mut self.nodes),
        };
    }
}

/// Where a range of items lies: its first item's place in the whole order, and the number of nodes above it.
#[derive(Clone, Copy)]
struct Place {
    first: u32,
    depth: u32,
}

#[derive(Clone, Copy)]
struct Range {
    bounds: Aabb,
    centres: Aabb,
}

impl Range {
    const EMPTY: Self = Self { bounds: Aabb::EMPTY, centres: Aabb::EMPTY };

    fn of(items: &[Item]) -> Self {
        items.iter().fold(Self::EMPTY, Self::with)
    }

    #[inline]
    fn with(self, item: &Item) -> Self {
        Self { bounds: self.bounds.union(item.bounds), centres: self.centres.with_point(item.bounds.centre()) }
    }
}

/// A subtree whose nodes are not yet in one array.
enum Part {
    /// Children count from the part's own first node.
    Serial {
        nodes: Vec<BvhNode>,
        root: u32,
    },
    Inner {
        bounds: [Aabb; 2],
        children: Box<[Part; 2]>,
    },
}

impl Part {
    fn append_to(self, nodes: &mut Vec<BvhNode>) -> u32 {
        let base = nodes.len() as u32;
        let moved = |child: u32| if child & BVH_LEAF == 0 { child + base } else { child };
        match self {
            Part::Serial { nodes: own, root } => {
                nodes.extend(own.iter().map(|n| BvhNode { child0: moved(n.child0), child1: moved(n.child1), ..*n }));
                moved(root)
            }
            Part::Inner { bounds, children } => {
                nodes.push(BvhNode::default());
                let children = children.map(|part| part.append_to(nodes));
                nodes[base as usize] = inner_node(bounds, children);
                base
            }
        }
    }
}

fn build_parallel(items: &mut [Item], range: Range, place: Place, limits: Limits) -> Part {
    if items.len() < SERIAL {
        let mut nodes = Vec::with_capacity(items.len());
        let root = build_serial(items, range, place, limits, &mut nodes);
        return Part::Serial { nodes, root };
    }
    let (middle, ranges) = split(items, &range, place.depth, limits).expect("a range this long is no leaf");
    let (left, right) = items.split_at_mut(middle);
    let [place_left, place_right] = place.split(middle);
    let children =
        rayon::join(|| build_parallel(left, ranges[0], place_left, limits), || build_parallel(right, ranges[1], place_right, limits));
    Part::Inner { bounds: ranges.map(|range| range.bounds), children: Box::new(children.into()) }
}

fn build_serial(items: &mut [Item], range: Range, place: Place, limits: Limits, nodes: &mut Vec<BvhNode>) -> u32 {
    let Some((middle, ranges)) = split(items, &range, place.depth, limits) else {
        let what = if limits.leaf == 1 { items[0].index } else { place.first };
        return BVH_LEAF | (items.len() as u32 - 1) << BVH_COUNT_SHIFT | what;
    };
    let node = nodes.len();
    nodes.push(BvhNode::default());
    let (left, right) = items.split_at_mut(middle);
    let [place_left, place_right] = place.split(middle);
    let children = [build_serial(left, ranges[0], place_left, limits, nodes), build_serial(right, ranges[1], place_right, limits, nodes)];
    nodes[node] = inner_node(ranges.map(|range| range.bounds), children);
    node as u32
}

impl Place {
    fn split(self, middle: usize) -> [Self; 2] {
        [Self { depth: self.depth + 1, ..self }, Self { first: self.first + middle as u32, depth: self.depth + 1 }]
    }
}

fn inner_node(bounds: [Aabb; 2], children: [u32; 2]) -> BvhNode {
    BvhNode {
        min0: bounds[0].min.to_array(),
        child0: children[0],
        max0: bounds[0].max.to_array(),
        child1: children[1],
        min1: bounds[1].min.to_array(),
        max1: bounds[1].max.to_array(),
        ..BvhNode::default()
    }
}

/// Puts the items of the left child first: their number, and both children's ranges. None: the range is a leaf.
fn split(items: &mut [Item], range: &Range, depth: u32, limits: Limits) -> Option<(usize, [Range; 2])> {
    if items.len() == 1 {
        return None;
    }
    let best = Bins::new(items, range).best_plane(range);
    if items.len() <= limits.leaf && best.as_ref().is_none_or(|plane| NODE_COST + plane.cost >= items.len() as f32) {
        return None;
    }
    let fits = |count: usize| depth + 1 + ceil_log2(count) <= limits.depth;
    match best {
        Some(plane) if fits(plane.left) && fits(items.len() - plane.left) => Some(partition(items, &plane)),
        _ => Some(halve(items, range)),
    }
}

fn ceil_log2(count: usize) -> u32 {
    count.next_power_of_two().trailing_zeros()
}

fn partition(items: &mut [Item], plane: &Plane) -> (usize, [Range; 2]) {
    let mut ranges = [Range::EMPTY; 2];
    let (mut left, mut right) = (0, items.len());
    while left < right {
        let item = items[left];
        if plane.mapping.bin(item.bounds.centre())[plane.axis] < plane.bin {
            ranges[0] = ranges[0].with(&item);
            left += 1;
        } else {
            ranges[1] = ranges[1].with(&item);
            right -= 1;
            items.swap(left, right);
        }
    }
    (left, ranges)
}

/// In equal halves along the longest axis: where centres coincide, where areas are past what floats can tell apart, and where the
/// depth runs out.
fn halve(items: &mut [Item], range: &Range) -> (usize, [Range; 2]) {
    let axis = longest_axis(range.centres.extent());
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| a.bounds.centre()[axis].total_cmp(&b.bounds.centre()[axis]));
    let (left, right) = items.split_at(middle);
    (middle, [Range::of(left), Range::of(right)])
}

fn longest_axis(extent: Vec3A) -> usize {
    (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).expect("three axes")
}

/// Centre to bin, per axis.
#[derive(Clone, Copy)]
struct Mapping {
    origin: Vec3A,
    scale: Vec3A,
}

impl Mapping {
    fn new(centres: &Aabb, bins: usize) -> Self {
        // A little less than the number of bins, so that the last centre stays in the last bin. Flat axes have one bin.
        let extent = centres.extent();
        let scale = Vec3A::splat(bins as f32 * (1.0 - 1e-6)) / extent;
        Self { origin: centres.min, scale: Vec3A::select(scale.is_finite_mask(), scale, Vec3A::ZERO) }
    }

    #[inline]
    fn bin(&self, centre: Vec3A) -> [usize; 3] {
        ((centre - self.origin) * self.scale).to_array().map(|bin| bin as usize)
    }
}

/// Where to split: the first `left` items lie in the bins before `bin`. `cost` is in triangle tests.
struct Plane {
    axis: usize,
    bin: usize,
    left: usize,
    cost: f32,
    mapping: Mapping,
}

struct Bins {
    bounds: [[Aabb; BINS]; 3],
    counts: [[u32; BINS]; 3],
    used: usize,
    mapping: Mapping,
}

impl Bins {
    fn new(items: &[Item], range: &Range) -> Self {
        let used = if items.len() < 4 * BINS { BINS / 2 } else { BINS };
        let mapping = Mapping::new(&range.centres, used);
        let mut bins = Self { bounds: [[Aabb::EMPTY; BINS]; 3], counts: [[0; BINS]; 3], used, mapping };
        for item in items {
            let places = mapping.bin(item.bounds.centre());
            for (axis, &place) in places.iter().enumerate() {
                let place = place.min(used - 1);
                bins.bounds[axis][place] = bins.bounds[axis][place].union(item.bounds);
                bins.counts[axis][place] += 1;
            }
        }
        bins
    }

    fn best_plane(&self, range: &Range) -> Option<Plane> {
        let measure = Measure::new(&range.bounds);
        let whole = measure.area(&range.bounds);
        let planes = (0..3).filter_map(|axis| self.best_on_axis(axis, &measure));
        let (axis, bin, left, area) = planes.min_by(|a, b| a.3.total_cmp(&b.3))?;
        Some(Plane { axis, bin, left, cost: area / whole, mapping: self.mapping })
    }

    /// (axis, first bin of the right side, items of the left side, area-weighted number of items).
    fn best_on_axis(&self, axis: usize, measure: &Measure) -> Option<(usize, usize, usize, f32)> {
        let (bounds, counts) = (&self.bounds[axis], &self.counts[axis]);
        let mut right = [(0, 0.0); BINS];
        let (mut sum, mut count) = (Aabb::EMPTY, 0);
        for bin in (1..self.used).rev() {
            sum = sum.union(bounds[bin]);
            count += counts[bin];
            right[bin] = (count, measure.area(&sum));
        }
        let (mut sum, mut count, mut best) = (Aabb::EMPTY, 0, None);
        for bin in 1..self.used {
            sum = sum.union(bounds[bin - 1]);
            count += counts[bin - 1];
            let (right_count, right_area) = right[bin];
            let cost = measure.area(&sum) * count as f32 + right_area * right_count as f32;
            if count > 0 && right_count > 0 && best.is_none_or(|(_, _, _, least)| cost < least) {
                best = Some((axis, bin, count as usize, cost));
            }
        }
        best
    }
}

/// Surface area in units of the node's own size, so that neither 10^-20 m nor 10^20 m leaves the range of floats. A small share of the
/// edge length keeps boxes without area, such as those along a line, in order.
struct Measure {
    unit: f32,
}

impl Measure {
    fn new(bounds: &Aabb) -> Self {
        Self { unit: 1.0 / bounds.extent().max_element().clamp(f32::MIN_POSITIVE, f32::MAX) }
    }

    #[inline]
    fn area(&self, bounds: &Aabb) -> f32 {
        let edge = bounds.extent() * self.unit;
        edge.dot(Vec3A::new(edge.y, edge.z, edge.x)) + 1e-6 * edge.element_sum()
    }
}
