//! The tree as boxes over the picture: a node that one can descend from, and its children.

use super::app::App;
use super::navigate;
use super::wish::Report;
use egui::{Color32, Pos2, Rect, Stroke, Ui};
use glam::Vec3;
use steradian::bvh::{Aabb, Bvh, BvhChild, Link, PrimitiveKind};
use steradian::scene::Camera;

const NODE: Color32 = Color32::from_rgb(255, 255, 255);
const LEFT: Color32 = Color32::from_rgb(90, 170, 255);
const RIGHT: Color32 = Color32::from_rgb(255, 160, 60);
const RAY: Color32 = Color32::from_rgb(120, 230, 120);

/// Where one stands in the tree.
#[derive(Default)]
pub(super) struct TreeView {
    pub(super) is_shown: bool,
    pub(super) is_ray_shown: bool,
    /// Children taken from the root, 0 left, 1 right.
    path: Vec<usize>,
    /// Cannot go on from here.
    is_leaf: bool,
    /// The ray of the last pick: from, to.
    pub(super) ray: Option<(Vec3, Vec3)>,
}

/// A node as it is shown.
struct Place {
    bounds: Aabb,
    /// Boxes of the children; none in a leaf.
    children: Vec<Aabb>,
    text: String,
}

impl TreeView {
    /// To a child of the node; stays at a leaf.
    pub(super) fn descend(&mut self, child: usize) {
        if self.is_shown && !self.is_leaf {
            self.path.push(child);
        }
    }

    /// To the parent; stays at the root.
    pub(super) fn ascend(&mut self) {
        self.path.pop();
    }
}

/// Draws boxes and ray in `rect`, the place of the whole picture.
pub(super) fn draw(ui: &mut Ui, app: &mut App, rect: Rect, report: &Report) {
    if !app.tree.is_shown {
        return;
    }
    let (Some(tree), Some(frame)) = (&report.tree, &app.canvas.shown) else { return };
    let place = find(tree, &mut app.tree.path);
    app.tree.is_leaf = place.children.is_empty();
    let painter = ui.painter().with_clip_rect(rect);
    let line = |from: Vec3, to: Vec3, stroke: Stroke| {
        if let Some((a, b)) = segment(&frame.camera, rect, from, to) {
            painter.line_segment([a, b], stroke);
        }
    };
    let colors = [LEFT, RIGHT];
    for (bounds, color) in place.children.iter().zip(colors) {
        edges(*bounds).for_each(|(a, b)| line(a, b, Stroke::new(1.2, color)));
    }
    edges(place.bounds).for_each(|(a, b)| line(a, b, Stroke::new(2.0, NODE)));
    if let (true, Some((from, to))) = (app.tree.is_ray_shown, app.tree.ray) {
        line(from, to, Stroke::new(2.0, RAY));
    }
    let corner = rect.left_top() + egui::vec2(12.0, 40.0);
    super::canvas::note(ui, corner, &place.text, rect.width() - 40.0);
}

/// The node at the end of a path, which is cut where the tree ends.
fn find(tree: &Bvh, path: &mut Vec<usize>) -> Place {
    let mut node = 0;
    let mut bounds = root_bounds(tree);
    for (depth, child) in path.clone().into_iter().enumerate() {
        let c = &tree.nodes[node].children[child];
        match c.target() {
            None | Some(Link::Leaf { count: 0, .. }) => {
                path.truncate(depth);
                break;
            }
            Some(Link::Leaf { kind, count, .. }) => {
                path.truncate(depth + 1);
                let text = format!("{}: leaf of {count} {}", steps(path), noun(kind, count));
                return Place { bounds: child_bounds(tree, c), children: Vec::new(), text };
            }
            Some(Link::Inner { node: next }) => {
                bounds = child_bounds(tree, c);
                node = next as usize;
            }
        }
    }
    let children: Vec<Aabb> = tree.nodes[node]
        .children
        .iter()
        .filter(|c| is_child(c))
        .map(|c| child_bounds(tree, c))
        .collect();
    let shares: Vec<_> =
        children.iter().map(|c| format!("{:.0} %", 100.0 * area(c) / area(&bounds))).collect();
    let text = format!(
        "{}: node {node} of {}, children have {} of its surface",
        steps(path),
        tree.nodes.len(),
        shares.join(" and ")
    );
    Place { bounds, children, text }
}

fn steps(path: &[usize]) -> String {
    match path.is_empty() {
        true => "root".into(),
        false => format!("level {}", path.len()),
    }
}

fn noun(kind: PrimitiveKind, count: u32) -> &'static str {
    match (kind, count) {
        (PrimitiveKind::Triangle, 1) => "triangle",
        (PrimitiveKind::Triangle, _) => "triangles",
        (PrimitiveKind::Sphere, 1) => "sphere",
        (PrimitiveKind::Sphere, _) => "spheres",
        (PrimitiveKind::Instance, _) => "placed mesh",
    }
}

fn area(b: &Aabb) -> f32 {
    let e = b.max - b.min;
    2.0 * (e.x * e.y + e.y * e.z + e.z * e.x).max(f32::MIN_POSITIVE)
}

fn child_bounds(tree: &Bvh, child: &BvhChild) -> Aabb {
    let plane = |q: [u32; 3]| tree.grid_min + tree.grid_scale * Vec3::from(q.map(|p| p as f32));
    Aabb { min: plane(child.lower()), max: plane(child.upper()) }
}

/// Roots of trees with one leaf have an empty second child.
fn is_child(c: &BvhChild) -> bool {
    !matches!(c.target(), None | Some(Link::Leaf { count: 0, .. }))
}

fn root_bounds(tree: &Bvh) -> Aabb {
    let children = tree.nodes[0].children.iter().filter(|c| is_child(c));
    let boxes = children.map(|c| child_bounds(tree, c));
    boxes
        .reduce(|a, b| Aabb { min: a.min.min(b.min), max: a.max.max(b.max) })
        .unwrap_or(Aabb { min: tree.grid_min, max: tree.grid_min })
}

/// The twelve edges of a box.
fn edges(b: Aabb) -> impl Iterator<Item = (Vec3, Vec3)> {
    let corner = move |k: usize| {
        let pick = |i: usize| if k >> i & 1 == 0 { b.min[i] } else { b.max[i] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    (0..8).flat_map(move |k| {
        (0..3).filter(move |i| k >> i & 1 == 0).map(move |i| (corner(k), corner(k | 1 << i)))
    })
}

/// The part of a segment that is before the camera, on the display.
fn segment(camera: &Camera, rect: Rect, from: Vec3, to: Vec3) -> Option<(Pos2, Pos2)> {
    let aspect_ratio = rect.width() / rect.height();
    let depth = |p: Vec3| (p - navigate::eye(camera)).dot(navigate::forward(camera));
    // Lines end a little before the camera: at it they would have no place.
    let near = (depth(from).abs() + depth(to).abs()) * 1e-3;
    let (mut a, mut b) = (from, to);
    let (da, db) = (depth(a) - near, depth(b) - near);
    match (da <= 0.0, db <= 0.0) {
        (true, true) => return None,
        (true, false) => a = a.lerp(b, da / (da - db)),
        (false, true) => b = b.lerp(a, db / (db - da)),
        _ => {}
    }
    let at = |p: Vec3| {
        let (x, y) = navigate::project(camera, p, aspect_ratio)?;
        let half = rect.size() * 0.5;
        Some(rect.center() + egui::vec2(x * half.x, -y * half.y))
    };
    Some((at(a)?, at(b)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use steradian::bvh::{BuildItem, build_sah};

    fn tree() -> Bvh {
        let items: Vec<_> = (0..64)
            .map(|i| {
                let min = Vec3::new((i % 8) as f32, (i / 8) as f32, 0.0);
                let bounds = Aabb { min, max: min + Vec3::splat(0.5) };
                BuildItem { bounds, kind: PrimitiveKind::Triangle }
            })
            .collect();
        build_sah(&items)
    }

    #[test]
    fn every_path_ends_in_a_leaf_and_boxes_shrink() {
        let tree = tree();
        for pattern in 0..64_u32 {
            let mut view = TreeView { is_shown: true, ..TreeView::default() };
            let mut last = find(&tree, &mut view.path);
            assert!(last.text.starts_with("root"));
            for step in 0..64 {
                view.is_leaf = last.children.is_empty();
                view.descend((pattern >> (step % 6) & 1) as usize);
                let place = find(&tree, &mut view.path);
                let slack = Vec3::splat(1e-3);
                assert!(place.bounds.min.cmpge(last.bounds.min - slack).all());
                assert!(place.bounds.max.cmple(last.bounds.max + slack).all());
                last = place;
            }
            assert!(last.text.contains("leaf of"), "{}", last.text);
            let depth = view.path.len();
            for _ in 0..depth + 3 {
                view.ascend();
            }
            assert!(find(&tree, &mut view.path).text.starts_with("root"));
        }
    }

    #[test]
    fn a_box_has_twelve_edges_along_the_axes() {
        let b = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 3.0) };
        let all: Vec<_> = edges(b).collect();
        assert_eq!(all.len(), 12);
        let sum: f32 = all.iter().map(|(a, b)| a.distance(*b)).sum();
        assert_eq!(sum, 4.0 * (1.0 + 2.0 + 3.0));
    }

    #[test]
    fn lines_are_cut_at_the_camera() {
        let c = Camera::framing((Vec3::splat(-1.0), Vec3::ONE));
        let rect = Rect::from_min_size(Pos2::ZERO, egui::vec2(100.0, 100.0));
        let behind = navigate::eye(&c) - navigate::forward(&c);
        assert!(segment(&c, rect, behind, behind + Vec3::X * 1e-3).is_none());
        let (_, b) = segment(&c, rect, behind, Vec3::ZERO).unwrap();
        assert!((b - rect.center()).length() < 1e-3);
    }
}
