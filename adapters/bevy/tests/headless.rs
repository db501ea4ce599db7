//! The plugin in an application without a window.

use bevy_app::App;
use bevy_ecs::prelude::Entity;
use bevy_transform::TransformPlugin;
use bevy_transform::components::Transform;
use echomarch::scene::shape::{Cuboid, Room};
use echomarch::simulator::{EarsSpec, SimulatorSettings, Update};
use echomarch::{Error, Surface};
use echomarch_bevy::{Acoustics, EchomarchPlugin, Heard, SoundListener, SoundSource, SoundSurface};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time that a test waits for updates.
const LIMIT: Duration = Duration::from_secs(60);

fn room() -> SoundSurface {
    let size = [8.0, 3.0, 6.0].into();
    SoundSurface(Surface::new(Room { size }).with_material("plasterboard"))
}

fn app() -> Result<App, Error> {
    let mut app = App::new();
    let settings = SimulatorSettings::default().with_seconds(0.3, 0.3);
    app.add_plugins((TransformPlugin, EchomarchPlugin::start(settings)?));
    Ok(app)
}

/// Updates the application until the source is heard as expected.
fn wait_for(app: &mut App, source: Entity, is_it: impl Fn(Option<&Arc<Update>>) -> bool) {
    let began = Instant::now();
    loop {
        app.update();
        let heard = app.world().resource::<Heard>().0.get(&source);
        if is_it(heard) {
            return;
        }
        assert!(began.elapsed() < LIMIT, "{heard:?}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Protects the plugin: entities are heard where they are, also children of moved parents; a wall hides; and removed
/// entities are silent.
#[test]
fn entities_are_heard_where_they_are() -> Result<(), Error> {
    let mut app = app()?;
    let world = app.world_mut();
    world.spawn(room());
    world.spawn((SoundListener, Transform::from_xyz(-1.0, 0.0, 0.0)));
    let cart = world.spawn(Transform::from_xyz(1.0, 0.0, 0.0)).id();
    let source = (
        SoundSource::default(),
        Transform::from_xyz(0.0, 0.5, 0.0),
        bevy_ecs::prelude::ChildOf(cart),
    );
    let dog = world.spawn(source).id();
    let distance = |heard: Option<&Arc<Update>>| {
        heard
            .filter(|heard| heard.traces > 0)
            .map_or(0.0, |heard| heard.direct.delay_s * 343.0)
    };
    let is_near = |distance: f64, wanted: f64| (distance - wanted).abs() < 0.02;
    wait_for(&mut app, dog, |heard| {
        is_near(distance(heard), 2.0_f64.hypot(0.5))
    });
    // The cart takes the source along.
    app.world_mut()
        .entity_mut(cart)
        .insert(Transform::from_xyz(2.0, 0.0, 0.0));
    wait_for(&mut app, dog, |heard| {
        is_near(distance(heard), 3.0_f64.hypot(0.5))
    });
    let size = [0.2, 3.0, 3.0].into();
    let wall = SoundSurface(Surface::new(Cuboid { size }).with_material("brick"));
    let wall = app.world_mut().spawn(wall).id();
    wait_for(&mut app, dog, |heard| {
        heard.is_some_and(|heard| !heard.direct.is_in_sight)
    });
    app.world_mut().despawn(wall);
    wait_for(&mut app, dog, |heard| {
        heard.is_some_and(|heard| heard.direct.is_in_sight)
    });
    assert!(app.world().resource::<Acoustics>().source(dog).is_some());
    app.world_mut().despawn(dog);
    wait_for(&mut app, dog, |heard| heard.is_none());
    let acoustics = app.world().resource::<Acoustics>();
    assert!(acoustics.source(dog).is_none() && acoustics.refused().is_empty());
    Ok(())
}

/// Protects games with a fault in one entity: the reason is kept with the entity, and the others are heard.
#[test]
fn a_refused_entity_does_not_silence_the_others() -> Result<(), Error> {
    let mut app = app()?;
    let world = app.world_mut();
    world.spawn(room());
    world.spawn((SoundListener, Transform::from_xyz(-1.0, 0.0, 0.0)));
    let size = [-1.0, 1.0, 1.0].into();
    let bad = world
        .spawn(SoundSurface(Surface::new(Cuboid { size })))
        .id();
    let dog = world
        .spawn((SoundSource::default(), Transform::from_xyz(1.0, 0.0, 0.0)))
        .id();
    let lost = (
        SoundSource::default(),
        Transform::from_xyz(f32::NAN, 0.0, 0.0),
    );
    let lost = world.spawn(lost).id();
    wait_for(&mut app, dog, |heard| {
        heard.is_some_and(|heard| heard.traces > 0)
    });
    let acoustics = app.world().resource::<Acoustics>();
    assert_eq!(acoustics.refused().len(), 2, "{:?}", acoustics.refused());
    assert!(acoustics.refused().contains_key(&bad) && acoustics.refused().contains_key(&lost));
    let mut mix = acoustics.mix(&EarsSpec::new(48_000))?;
    let mut stereo = [0.0; 64];
    mix.process(&mut stereo, |_, _| ());
    Ok(())
}
