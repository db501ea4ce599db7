//! Every sequence of planes that has a path, up to an order: the tree of the source's images.
//!
//! In rooms of planes waves would miss paths whose beams are narrow, and the energy of these with them. But there the
//! images of the source are few enough to try them all: one is mirrored only at planes whose air it is in, as a path
//! cannot come to a plane from behind. A source on a plane is in its air: its image there is itself.

use super::candidates::Candidates;
use super::sheet::Sheet;
use super::surfaces::{Surfaces, Vertex};
use super::{Ends, images};
use glam::DVec3;

/// Images at most, some tens of milliseconds: in a room all up to order 8.
const MOST_IMAGES: usize = 1 << 17;

/// Nodes of a field for which so many images are tried; of a larger one fewer, as for each its value is computed.
const NODES: usize = 16;

/// Images times planes of a level at most: some tens of milliseconds as well, where planes are thousands.
const MOST_TRIED: usize = 1 << 24;

/// An image of the source: mirrored at a plane, and before as its parent was.
struct Image {
    place: DVec3,
    plane: usize,
    /// The index of the image that was mirrored; none for those of the source itself.
    parent: Option<usize>,
}

/// Adds each sequence of planes of `surfaces`, `order` of them at most, over which sound could go from the source
/// to the listener if nothing were in the way: it names its path, as what was searched besides the waves. Returns up
/// to how many planes no sequence was left out.
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

/// Adds the images of a place (the source, or its image of this index) in all planes whose air it is in, but for the one
/// that it is an image in. The source, and an image at the same place, are also in the air of what they lie on, but for
/// what mirrored them already.
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

/// Where the line to an image is mirrored; `None` if it misses one of the surfaces.
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
