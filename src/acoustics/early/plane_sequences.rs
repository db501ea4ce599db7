//! Finds every sequence of planes with a path, up to an order, by the tree of the source's images.
//!
//! In rooms of planes waves would miss paths with narrow beams, and their energy. But there the images of the source
//! are few enough to try them all: one is mirrored only at planes that have it on their air side, as a path cannot
//! reach a plane from behind. A source on a plane counts as on its air side: its image there is itself.

use super::candidates::Candidates;
use super::sheet::Sheet;
use super::surfaces::{Surfaces, Vertex};
use super::{Ends, images};
use glam::DVec3;

/// Maximum number of images, a few tens of milliseconds: in a room all up to order 8.
const MOST_IMAGES: usize = 1 << 17;

/// Maximum number of a field's nodes for which that many images are tried; for a larger field fewer, as its value
/// is computed for each.
const NODES: usize = 16;

/// Maximum product of images and planes in a level: also a few tens of milliseconds, with thousands of
/// planes.
const MOST_TRIED: usize = 1 << 24;

/// An image of the source: the image of its parent in a plane.
struct Image {
    place: DVec3,
    plane: usize,
    /// The index of the image that was mirrored; `None` for those of the source itself.
    parent: Option<usize>,
}

/// Adds each sequence of at most `order` planes of `surfaces` over which sound could go from the source to the
/// listener if nothing were in the way: it names its path, which counts as searched for. Returns the number of
/// planes up to which all sequences were tried.
pub(super) fn add_all(
    surfaces: &Surfaces,
    ends: &Ends,
    order: u32,
    candidates: &mut Candidates,
) -> u32 {
    let planes = surfaces.planes();
    let most_images = MOST_IMAGES * NODES / surfaces.most_nodes_of_planes().max(NODES);
    let mut tree: Vec<Image> = Vec::new();
    let mut last_level = 0..0;
    let searched = candidates.waves() as u32;
    let source = (ends.source, surfaces.touch);
    for level in 1..=order {
        if last_level.len() * planes.len() > MOST_TRIED {
            return level - 1;
        }
        let begin = tree.len();
        if level == 1 {
            mirror(&mut tree, &planes, source, (ends.source, None));
        }
        for parent in last_level {
            let place = tree[parent].place;
            mirror(&mut tree, &planes, source, (place, Some(parent)));
            if tree.len() > most_images {
                return level - 1;
            }
        }
        last_level = begin..tree.len();
        for image in last_level.clone() {
            if let Some(vertices) = vertices(surfaces, ends, &planes, &tree, image) {
                candidates.add(searched, &vertices);
            }
        }
    }
    order
}

/// Adds the images of a point (the source, or its image with this index) in all planes that have it on their air side,
/// except the plane that made this image. The source, and an image at the same place, also count as on the air side of
/// planes that they lie on, except those that already mirrored them.
fn mirror(
    tree: &mut Vec<Image>,
    planes: &[(u32, Sheet)],
    (source, touch): (DVec3, f64),
    (place, parent): (DVec3, Option<usize>),
) {
    let (least, mirrored_in) = match place.distance(source) <= touch {
        true => (-touch, usize::MAX),
        false => (0.0, 1),
    };
    let line = std::iter::successors(parent, |image| tree[*image].parent);
    let behind: Vec<usize> = line
        .take(mirrored_in)
        .map(|image| tree[image].plane)
        .collect();
    for (plane, (_, sheet)) in planes.iter().enumerate() {
        let Some((normal, offset)) = sheet.plane() else {
            continue;
        };
        if !behind.contains(&plane) && place.dot(normal) - offset > least {
            tree.push(Image {
                place: images::image(place, normal, offset),
                plane,
                parent,
            });
        }
    }
}

/// The points where the line to an image is mirrored; `None` if it misses one of the surfaces.
fn vertices(
    surfaces: &Surfaces,
    ends: &Ends,
    planes: &[(u32, Sheet)],
    tree: &[Image],
    image: usize,
) -> Option<Vec<Vertex>> {
    let line = std::iter::successors(Some(image), |image| tree[*image].parent);
    let mut sequence: Vec<&(u32, Sheet)> = line.map(|image| &planes[tree[image].plane]).collect();
    sequence.reverse();
    let points = images::points(
        ends.source,
        ends.listener,
        surfaces.touch,
        sequence.iter().map(|(_, s)| s),
    )?;
    let vertex = |((surface, sheet), point): (&&(u32, Sheet), DVec3)| {
        let normal = sheet.at(point)?.normal;
        surfaces.has(*surface, point).then_some(Vertex {
            point,
            normal,
            surface: *surface,
        })
    };
    sequence.iter().zip(points).map(vertex).collect()
}
