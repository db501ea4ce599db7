//! Compares the values, gradients and hits of the shaders with those of the CPU.

use super::{has_marched_fields, parts_of, world_values};
use crate::geometry::ExactScene;
use crate::gl::{Api, Context, DataList, Program, RenderTarget, Texture, full_screen_pass};
use crate::scene::shape::Ellipsoid;
use crate::scene::shape::tests::table::{Entry, entries, scene_of, surfaces, to_local, to_world};
use crate::scene::shape::tests::trees;
use crate::scene::{Exactness, Motion, Node};
use crate::shader::scene_data::assets as asset_data;
use crate::shader::text::{ListenerText, Part, closed_form_parts, directed_parts, link};
use crate::shader::turn_budget::MAX_COPY_STEPS;
use crate::shader::{self, Lists, Structure};
use crate::test_common::{Random, context};
use crate::{Scene, Surface};
use glam::{DVec3, Vec3};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;

/// Number of fields in one shader. With this number there are few programs to compile, and each is small.
const IN_ONE: usize = 8;

/// Runs a shader with the function `vec4 answer(int which, vec3 p, vec3 d)` for many points.
pub struct Asked {
    context: Context,
    program: Program,
    data: DataList,
}

impl Asked {
    pub fn new(context: &Context, scene: &Scene, parts: Vec<Part>, ask: String) -> Asked {
        let main = "
uniform highp sampler2D uPoints;
uniform highp sampler2D uDirections;
uniform int uWhich;
layout(location = 0) out vec4 outAnswer;
void main() {
    copyUniforms();
    ivec2 at = ivec2(gl_FragCoord.xy);
    outAnswer = answer(uWhich, texelFetch(uPoints, at, 0).xyz, texelFetch(uDirections, at, 0).xyz);
}
";
        let counters = "#define COUNT_EVALUATIONS(n)\nconst float STATUS_LISTENER = 0.0;\n";
        let roots = vec![
            shader::Source::new("counters", counters),
            shader::Source::new("ask", ask + main),
        ];
        let text = shader::join(&link(roots, parts));
        let program = Program::fragment(context, "ask", &text)
            .unwrap_or_else(|error| panic!("{error}\n{:#?}", scene.surfaces));
        let mut data = DataList::new(context, shader::DATA_WIDTH).unwrap();
        let assets = Structure::of(scene, Lists::Lines).assets;
        data.set(&asset_data(&assets)).unwrap();
        let values = world_values(scene, Lists::Lines);
        program.set_vec4_array("uSurfaces", &values);
        let listener = scene.listeners[0]
            .position
            .extend(scene.listeners[0].radius);
        program.set_vec4("uListener", listener);
        program.set_i32("uCopySteps", MAX_COPY_STEPS as i32);
        Asked {
            context: context.clone(),
            program,
            data,
        }
    }

    pub fn ask(&self, which: usize, points: &[Vec3], directions: &[Vec3]) -> Vec<[f32; 4]> {
        let width = 64;
        let height = (points.len() as u32).div_ceil(width);
        let upload = |vectors: &[Vec3]| {
            let mut texels: Vec<f32> = vectors.iter().flat_map(|p| [p.x, p.y, p.z, 0.0]).collect();
            texels.resize(4 * (width * height) as usize, 1.0);
            let texture = Texture::new(&self.context, width, height).unwrap();
            texture.upload(&texels).unwrap();
            texture
        };
        let (points_in, directions_in) = (upload(points), upload(directions));
        let output = Texture::new(&self.context, width, height).unwrap();
        let target = RenderTarget::new(&self.context, &[&output]).unwrap();
        self.program.set_texture("uPoints", 0, &points_in);
        self.program.set_texture("uDirections", 1, &directions_in);
        self.data.bind(&self.program, "uSceneData", 2);
        self.program.set_i32("uWhich", which as i32);
        full_screen_pass(&self.context, &self.program, &target, width, height).unwrap();
        let read = target.read(0).unwrap();
        read.as_chunks::<4>().0[..points.len()].to_vec()
    }
}

/// One unit in the last place of the largest number in an evaluation.
pub fn unit(entry: &Entry, surface: &Surface, p: Vec3) -> f64 {
    let size = p.length() + surface.position.length();
    f64::from(f32::EPSILON) * (f64::from(size) + entry.reach()) * awkwardness(entry)
}

/// The factor by which a node amplifies earlier rounding errors. The terms of a quadric cancel (by the square of an
/// ellipsoid's stretch), and a rotation multiplies the rounding error of an angle by the radius.
fn awkwardness(entry: &Entry) -> f64 {
    let of_node = |node: &Node| match node {
        Node::Ellipsoid(Ellipsoid { radii }) => {
            f64::from(radii.max_element() / radii.min_element()).powi(2)
        }
        Node::Paraboloid(_) | Node::Hyperboloid(_) | Node::GeneralQuadric(_) => 4.0,
        Node::Twist(_) | Node::Bend(_) => 8.0,
        _ => 1.0,
    };
    let nodes = entry.field.nodes();
    nodes.iter().map(|f| of_node(&f.node)).fold(1.0, f64::max)
}

/// Points near the surface, far from it, on it and inside it, in its own axes.
pub fn points(entry: &Entry, random: &mut Random) -> Vec<DVec3> {
    let reach = entry.reach();
    let mut all = vec![DVec3::ZERO];
    for length in [0.01, 0.1, 0.3, 0.6, 0.9, 1.0, 1.5, 3.0, 20.0] {
        for _ in 0..12 {
            all.push(length * reach * random.direction());
        }
    }
    for _ in 0..40 {
        // Newton steps towards the surface, with the value on the CPU.
        let mut p = 0.9 * reach * random.direction() * random.unit();
        for _ in 0..6 {
            p -= gradient(entry, p) * entry.distance(p);
        }
        if p.length() < 4.0 * reach {
            all.push(p);
        }
    }
    all
}

pub fn gradient(entry: &Entry, p: DVec3) -> DVec3 {
    let step = 1e-6 * entry.reach();
    let along = |axis: DVec3| {
        (entry.distance(p + axis * step) - entry.distance(p - axis * step)) / (2.0 * step)
    };
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}

/// Whether the gradient is nearly constant within `within` metres, in twelve random directions.
fn is_smooth(entry: &Entry, p: DVec3, within: f64) -> bool {
    let here = gradient(entry, p);
    let mut random = Random(1);
    (0..12).all(|_| (gradient(entry, p + within * random.direction()) - here).length() < 0.01)
}

fn field_calls(count: usize) -> String {
    let mut text = String::from("vec4 answer(int which, vec3 p, vec3 d) {\n");
    for index in 0..count {
        let number = index + 1;
        text += &format!(
            "    if (which == {}) {{ return GRADIENT{number}(p); }}\n",
            2 * index + 1
        );
        text += &format!(
            "    if (which == {}) {{ return vec4(VALUE{number}(p)); }}\n",
            2 * index
        );
    }
    text + "    return vec4(0.0);\n}\n"
}

/// A shader for the values and gradients of the fields of one scene.
fn asked(context: &Context, scene: &Scene) -> Asked {
    let mut ask = String::new();
    let mut first = 0;
    for (index, surface) in scene.surfaces.iter().enumerate() {
        let number = index + 1;
        let offset = format!("q - surfaceValue{first}.xyz");
        let place = if surface.has_rotation() {
            format!("turn(surfaceValue{}, {offset})", first + 1)
        } else {
            offset
        };
        ask += &format!("float VALUE{number}(vec3 q) {{ return field{number}({place}); }}\n");
        let turned_back = match surface.has_rotation() {
            true => format!(
                "vec4(turn(surfaceValue{} * vec4(-1, -1, -1, 1), g.xyz), g.w)",
                first + 1
            ),
            false => "g".to_owned(),
        };
        ask += &format!(
            "vec4 GRADIENT{number}(vec3 q) {{ vec4 g = gradient{number}({place}); return {turned_back}; }}\n"
        );
        let alone = scene_of(vec![surface.clone()]);
        first += Structure::of(&alone, Lists::Lines).uniform_count(&alone);
    }
    ask += &field_calls(scene.surfaces.len());
    let parts = parts_of(scene, Lists::Overlapping, |text| {
        directed_parts(text, ListenerText::Solid)
    });
    Asked::new(context, scene, parts, ask)
}

#[derive(Default)]
struct Worst {
    ulps: f64,
    turned: f64,
    length: f64,
}

fn check_batch(context: &Context, batch: &[(Entry, Surface)], worst: &mut Worst) -> Vec<String> {
    let scene = scene_of(batch.iter().map(|(_, surface)| surface.clone()).collect());
    let asked = asked(context, &scene);
    let mut failures = Vec::new();
    for (index, (entry, surface)) in batch.iter().enumerate() {
        let local = points(entry, &mut Random(11));
        let world: Vec<Vec3> = local.iter().map(|p| to_world(surface, *p)).collect();
        let values = asked.ask(2 * index, &world, &world);
        let gradients = asked.ask(2 * index + 1, &world, &world);
        let properties = entry.field.properties();
        for (at, p) in world.iter().enumerate() {
            let q = to_local(surface, *p);
            let (here, there) = (entry.distance(q), f64::from(values[at][0]));
            let unit = unit(entry, surface, *p);
            let ulps = (here - there).abs() / unit;
            worst.ulps = worst.ulps.max(ulps);
            if ulps.is_nan() || ulps > VALUE_ULPS {
                failures.push(format!(
                    "{there}, here {here} ({ulps} ulps) at {q}: {}",
                    entry.name
                ));
                break;
            }
            let [x, y, z, _] = gradients[at].map(f64::from);
            let turn = surface.rotation.as_dquat().normalize();
            let there = turn.inverse() * DVec3::new(x, y, z);
            // The gradient of a user's field is computed from differences over a step.
            let step = if entry.truth.is_some() { 2e-3 } else { 1e-4 };
            let within = 64.0 * unit + step * entry.reach();
            worst.length = worst.length.max(there.length());
            if there.is_nan() || there.length() > 1.0 + GRADIENT {
                failures.push(format!("gradient {there} too long at {q}: {}", entry.name));
                break;
            }
            if !is_smooth(entry, q, within) {
                continue;
            }
            let here = gradient(entry, q);
            let gap = (here - there).length();
            worst.turned = worst.turned.max(gap);
            let side = if values[at][0] > 0.0 {
                properties.in_air
            } else {
                properties.in_solid
            };
            let short = side == Exactness::Exact && there.length() < 1.0 - GRADIENT;
            if gap > GRADIENT || short {
                failures.push(format!(
                    "gradient {there}, here {here} at {q}: {}",
                    entry.name
                ));
                break;
            }
        }
    }
    failures
}

/// Maximum difference of values, in units: about four operations per node, at most eight nested nodes, and a rotation
/// of the whole field. (Measured with llvmpipe: at most 2.2.)
const VALUE_ULPS: f64 = 16.0;

/// Maximum difference of gradients. A point counts as smooth if the gradients on the CPU differ by less than 0.01
/// within rounding. (Measured with llvmpipe: differences of at most 1.1e-3, and lengths of at most 1.016.)
const GRADIENT: f64 = 0.03;

/// The same surface with all numbers of its field in uniforms instead of literals.
fn driven(surface: Surface) -> Surface {
    let mut named = surface.clone();
    let numbers = named.parameters_mut().into_iter();
    let own = numbers
        .map(|parameter| parameter.name)
        .filter(|name| !name.starts_with("position") && !name.starts_with("rotation"));
    own.fold(surface, |surface, name| {
        surface.driven(&name, Motion::Named("value".to_owned()))
    })
}

fn pairs(all: Vec<Entry>) -> Vec<(Entry, Surface)> {
    let placed = |entry: Entry| {
        let [plain, placed] = surfaces(&entry);
        let all = [plain.clone(), placed, driven(plain)];
        all.map(|surface| (entry.clone(), surface))
    };
    all.into_iter().flat_map(placed).collect()
}

/// Protects the shaders' values and gradients: they equal those of the CPU for every shape and operator, unchanged,
/// displaced, and with driven numbers. One API is enough, because other tests cover passes on all APIs.
#[test]
fn shaders_and_cpu_agree_on_values_and_gradients() {
    let context = context(Api::Gl);
    let mut worst = Worst::default();
    let mut failures = Vec::new();
    for batch in pairs(entries()).chunks(IN_ONE) {
        failures.extend(check_batch(&context, batch, &mut worst));
    }
    println!(
        "{} ulps, gradients {}, length {}",
        worst.ulps, worst.turned, worst.length
    );
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Protects the shaders' values and gradients of random trees.
#[test]
fn shaders_and_cpu_agree_on_random_trees() {
    let context = context(Api::Gl);
    let mut runner = TestRunner::deterministic();
    let tree = trees();
    let random: Vec<Entry> = (0..24)
        .map(|index| Entry {
            name: format!("random {index}"),
            field: tree.new_tree(&mut runner).unwrap().current(),
            truth: None,
        })
        .filter(|entry| entry.field.nodes().len() < 40)
        .map(|entry| Entry {
            name: format!("{} {:?}", entry.name, entry.field),
            ..entry
        })
        .collect();
    let mut worst = Worst::default();
    let mut failures = Vec::new();
    let batches = random.into_iter().map(|entry| {
        let [_, placed] = surfaces(&entry);
        (entry, placed)
    });
    for batch in batches.collect::<Vec<_>>().chunks(IN_ONE / 2) {
        failures.extend(check_batch(&context, batch, &mut worst));
    }
    println!("{} ulps, gradients {}", worst.ulps, worst.turned);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Maximum difference of hits, in units of the position, divided by the cosine of the angle of incidence. The
/// difference is the error of the value, amplified by a discriminant whose terms cancel. (Measured with llvmpipe: at
/// most 26 if the cosine is above 0.1.)
const HIT_ULPS: f64 = 64.0;

/// Protects closed forms: a line hits a field at the same point as the march in f64, from the air and when it leaves
/// the surface. Lines are left out if slightly shifted lines have a different result.
#[test]
fn closed_forms_meet_what_a_march_meets() {
    let context = context(Api::Gl);
    let mut failures = Vec::new();
    let (mut tried, mut left_out, mut most) = (0, 0, 0f64);
    for (entry, surface) in pairs(entries()) {
        let scene = scene_of(vec![surface.clone()]);
        if has_marched_fields(&scene) {
            continue;
        }
        let exact = ExactScene::new(&scene).unwrap();
        let mut ask = String::from("vec4 answer(int which, vec3 p, vec3 d) {\n");
        ask += "    float object;\n    float t = closestHit(p, d, -1.0, NO_HIT, object);\n";
        ask += "    return vec4(t, object, 0.0, 0.0);\n}\n";
        let asked = Asked::new(
            &context,
            &scene,
            parts_of(&scene, Lists::Lines, |text| {
                closed_form_parts(text, ListenerText::Solid)
            }),
            ask,
        );
        let mut random = Random(23);
        let mut lines: Vec<(Vec3, Vec3)> = Vec::new();
        for _ in 0..400 {
            let reach = 3.0 * entry.reach();
            let aim = 0.8 * entry.reach() * random.unit() * random.direction();
            let from = to_world(&surface, reach * random.unit() * random.direction());
            let direction = (to_world(&surface, aim) - from).normalize_or(Vec3::X);
            if entry.distance(to_local(&surface, from)) > 1e-3 * entry.reach() {
                lines.push((from, direction));
                // A line that leaves the surface.
                if let Some(hit) = exact.closest_hit(from.as_dvec3(), direction.as_dvec3()) {
                    let d = direction.as_dvec3();
                    let mirrored = d - 2.0 * d.dot(hit.normal) * hit.normal;
                    if hit.object == 1 && mirrored.dot(hit.normal) > 0.05 {
                        lines.push((hit.point.as_vec3(), mirrored.as_vec3().normalize()));
                    }
                }
            }
        }
        let (starts, directions): (Vec<Vec3>, Vec<Vec3>) = lines.iter().copied().unzip();
        let answers = asked.ask(0, &starts, &directions);
        for ((from, direction), answer) in lines.iter().zip(answers) {
            let meet = |aside: DVec3| {
                let from = from.as_dvec3() + aside;
                let hit = exact.closest_hit(from, direction.as_dvec3().normalize())?;
                (hit.object == 1).then_some(hit)
            };
            let unit = unit(&entry, &surface, *from);
            tried += 1;
            let here = meet(DVec3::ZERO);
            let there = (answer[0] < 1e29 && answer[1] == 1.0).then_some(f64::from(answer[0]));
            let closing = here.map_or(1.0, |hit| -hit.normal.dot(direction.as_dvec3()));
            let allowed = HIT_ULPS * unit / closing.max(1e-3);
            let same = match (here, there) {
                (None, None) => true,
                (Some(hit), Some(t)) => {
                    let gap = (hit.t - t).abs();
                    if gap <= allowed && closing > 0.1 {
                        most = most.max(gap * closing / unit);
                    }
                    gap <= allowed
                }
                _ => false,
            };
            if same {
                continue;
            }
            let (one, other) = direction.as_dvec3().any_orthonormal_pair();
            let hair = 1e-4 * entry.reach() + 16.0 * unit;
            let close = [one, -one, other, -other].iter().any(|aside| {
                let twin = meet(*aside * hair);
                match (here, twin) {
                    (Some(a), Some(b)) => (a.t - b.t).abs() > 30.0 * hair,
                    (None, None) => false,
                    _ => true,
                }
            });
            if close {
                left_out += 1;
                continue;
            }
            failures.push(format!(
                "{there:?}, here {:?} from {} along {direction}: {}",
                here.map(|hit| hit.t),
                to_local(&surface, *from),
                entry.name
            ));
            break;
        }
    }
    println!("{tried} lines, {left_out} left out, {most} ulps");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(
        50 * left_out < tried,
        "{left_out} of {tried} lines are close calls"
    );
}
