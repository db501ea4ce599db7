//! A source and a listener of a scene: the input of a frame, a response or a picture.

use super::{Listener, Nearest, Scene, SceneError, Source};
use glam::Vec3;
use sealed::{Chosen, Viewpoint};

/// One source and one listener of a scene.
///
/// [`Scene::pair`] selects a pair; [`Scene::only_pair`] returns the pair of a scene with one source and one listener. A
/// pair borrows the scene without copying it.
///
/// Two pairs are equal if their surfaces, materials, air, sources and listeners are equal. The names of the scenes and
/// all other sources and listeners are ignored.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) source: &'a Source,
    pub(crate) listener: &'a Listener,
    indices: (usize, usize),
}

impl<'a> Pair<'a> {
    /// The scene that contains the source and the listener.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// The source.
    pub fn source(&self) -> &'a Source {
        self.source
    }

    /// The listener.
    pub fn listener(&self) -> &'a Listener {
        self.listener
    }

    /// The indices of the source and of the listener, from 0, as passed to [`Scene::pair`]. With these indices,
    /// [`Scene::pair`] selects the same source and listener in another state of the scene, for example at another time.
    pub fn indices(&self) -> (usize, usize) {
        self.indices
    }

    /// Signed distance in metres from a world point to the nearest surface or to the listener's sphere. The march in
    /// the thesis evaluates this function (figure 9).
    pub fn distance(&self, point: impl Into<[f32; 3]>) -> Nearest {
        let point = Vec3::from(point.into());
        let listener = Nearest {
            distance: self.listener.distance(point),
            object: 0,
        };
        self.scene.nearest_surface(point, listener)
    }
}

impl PartialEq for Pair<'_> {
    fn eq(&self, other: &Pair) -> bool {
        let (a, b) = (self.scene, other.scene);
        self.source == other.source
            && self.listener == other.listener
            && a.air == b.air
            && a.materials == b.materials
            && a.scattering == b.scattering
            && a.surfaces == b.surfaces
    }
}

/// An input of traces and pictures: a [`Pair`], or a scene with exactly one source and one listener.
///
/// ```
/// use echomarch::gl::Context;
/// use echomarch::{Listener, Scene, Settings, Source, Tracer};
///
/// let mut tracer = Tracer::new(&Context::headless(&Default::default())?)?;
/// let settings = Settings::default().with_waves(1024);
/// let mut scene = Scene::builtin("corner")?;
/// tracer.frame(&scene, &settings)?;
///
/// scene.sources.push(Source::at([0.0, 1.0, 0.0]).named("flute"));
/// tracer.frame(scene.pair(1, 0)?, &settings)?;
/// assert!(tracer.frame(&scene, &settings).is_err()); // two sources
/// # Ok::<(), echomarch::Error>(())
/// ```
///
/// A picture needs a listener but no source, so a scene without a source can be drawn.
pub trait IntoPair<'a>: Chosen<'a> {}

impl<'a> IntoPair<'a> for Pair<'a> {}
impl<'a> IntoPair<'a> for &'a Scene {}

/// The two conversions, hidden from callers outside the crate.
pub(crate) mod sealed {
    use super::{Listener, Pair, Scene, SceneError, Source};

    pub trait Chosen<'a> {
        /// The input of a trace.
        fn chosen(self) -> Result<Pair<'a>, SceneError>;
        /// The input of a picture.
        fn viewpoint(self) -> Result<Viewpoint<'a>, SceneError>;
    }

    /// A scene to draw, with the source and the listener that the picture shows, if any.
    #[derive(Clone, Copy, Debug)]
    pub struct Viewpoint<'a> {
        pub scene: &'a Scene,
        pub source: Option<&'a Source>,
        pub listener: Option<&'a Listener>,
        /// The source and the listener as a pair; `None` if either is missing.
        pub pair: Option<Pair<'a>>,
    }
}

impl<'a> Chosen<'a> for Pair<'a> {
    fn chosen(self) -> Result<Pair<'a>, SceneError> {
        Ok(self)
    }

    fn viewpoint(self) -> Result<Viewpoint<'a>, SceneError> {
        Ok(Viewpoint {
            scene: self.scene,
            source: Some(self.source),
            listener: Some(self.listener),
            pair: Some(self),
        })
    }
}

impl<'a> Chosen<'a> for &'a Scene {
    fn chosen(self) -> Result<Pair<'a>, SceneError> {
        self.only_pair()
    }

    fn viewpoint(self) -> Result<Viewpoint<'a>, SceneError> {
        if self.sources.len() > 1 || self.listeners.len() > 1 {
            return Err(self.not_one_pair());
        }
        Ok(Viewpoint {
            scene: self,
            source: self.sources.first(),
            listener: self.listeners.first(),
            pair: self.only_pair().ok(),
        })
    }
}

#[cfg(feature = "picture")]
impl<'a> Viewpoint<'a> {
    /// The listener whose view the picture shows.
    ///
    /// # Errors
    /// [`SceneError::NotOnePair`] without a listener.
    pub(crate) fn listener(&self) -> Result<&'a Listener, SceneError> {
        self.listener.ok_or_else(|| self.scene.not_one_pair())
    }

    /// The source and the listener of the waves in the picture.
    ///
    /// # Errors
    /// [`SceneError::NotOnePair`] without a source or without a listener.
    pub(crate) fn pair(&self) -> Result<Pair<'a>, SceneError> {
        self.pair.ok_or_else(|| self.scene.not_one_pair())
    }
}

impl Scene {
    /// Selects the source and the listener with these indices, from 0, in [`Scene::sources`] and [`Scene::listeners`].
    ///
    /// ```
    /// use echomarch::{Scene, Source};
    ///
    /// let mut scene = Scene::builtin("corner")?;
    /// scene.sources.push(Source::at([0.0, 1.0, 0.0]).named("flute"));
    /// let flute = scene.pair(1, 0)?;
    /// assert_eq!(flute.source().name.as_deref(), Some("flute"));
    /// # Ok::<(), echomarch::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError::NoSuchNumber`] if an index is out of range.
    pub fn pair(&self, source: usize, listener: usize) -> Result<Pair<'_>, SceneError> {
        let none = |what, number, count| SceneError::NoSuchNumber {
            scene: self.name.clone(),
            what,
            number,
            count,
        };
        let (sources, listeners) = (&self.sources, &self.listeners);
        let from = sources.get(source);
        let to = listeners.get(listener);
        Ok(Pair {
            scene: self,
            source: from.ok_or_else(|| none("source", source, sources.len()))?,
            listener: to.ok_or_else(|| none("listener", listener, listeners.len()))?,
            indices: (source, listener),
        })
    }

    /// The only source and the only listener of a scene.
    ///
    /// # Errors
    /// [`SceneError::NotOnePair`] if the scene does not have exactly one source and one listener; [`Scene::pair`]
    /// selects among several.
    pub fn only_pair(&self) -> Result<Pair<'_>, SceneError> {
        match (self.sources.len(), self.listeners.len()) {
            (1, 1) => self.pair(0, 0),
            _ => Err(self.not_one_pair()),
        }
    }

    fn not_one_pair(&self) -> SceneError {
        SceneError::NotOnePair {
            scene: self.name.clone(),
            sources: self.sources.len(),
            listeners: self.listeners.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::Sphere;
    use crate::scene::{Air, Surface};

    /// A scene with a sphere, sources at 1 m, 2 m … along x, and listeners at 1 m, 2 m … along y.
    fn scene(sources: usize, listeners: usize) -> Scene {
        let ball = Surface::new(Sphere { radius: 0.5 });
        let mut scene = Scene::new(
            "ball",
            vec![ball],
            Source::at(Vec3::ZERO),
            Listener::at(Vec3::ZERO, 0.1),
        );
        let metres = |count: usize| (1..=count).map(|metres| metres as f32);
        scene.sources = metres(sources).map(|m| Source::at(Vec3::X * m)).collect();
        let listener = |m| Listener::at(Vec3::Y * m, 0.1);
        scene.listeners = metres(listeners).map(listener).collect();
        scene
    }

    /// Protects the selection by index, and callers from indices out of range.
    #[test]
    fn a_pair_is_what_the_numbers_say() {
        let scene = scene(2, 3);
        for (source, listener) in [(0, 0), (1, 0), (0, 2), (1, 2)] {
            let pair = scene.pair(source, listener).unwrap();
            assert_eq!(pair.source(), &scene.sources[source]);
            assert_eq!(pair.listener(), &scene.listeners[listener]);
            assert_eq!(pair.indices(), (source, listener));
        }
        let told = |pair: Result<Pair, SceneError>| pair.unwrap_err().to_string();
        let text = told(scene.pair(2, 0));
        assert!(text.contains("no source number 2: it has 2"), "{text}");
        let text = told(scene.pair(0, usize::MAX));
        assert!(text.contains("no listener number"), "{text}");
        assert!(text.contains("it has 3"), "{text}");
    }

    /// Protects callers from a silent default: a scene is a valid input only if it has exactly one source and one
    /// listener.
    #[test]
    fn the_only_pair_is_the_one_that_is_alone() {
        let alone = scene(1, 1);
        let pair = alone.only_pair().unwrap();
        assert_eq!(pair.source(), &alone.sources[0]);
        for (sources, listeners, told) in [
            (0, 1, "0 sources and 1 listener:"),
            (2, 1, "2 sources and 1 listener:"),
            (1, 0, "1 source and 0 listeners:"),
            (1, 3, "1 source and 3 listeners:"),
            (0, 0, "0 sources and 0 listeners:"),
        ] {
            let scene = scene(sources, listeners);
            let refused = scene.only_pair().unwrap_err();
            let text = refused.to_string();
            assert!(text.contains(told), "{text}");
            assert!(matches!(refused, SceneError::NotOnePair { .. }));
            assert!((&scene).chosen().is_err());
            assert_eq!(scene.viewpoint().is_ok(), sources < 2 && listeners < 2);
        }
    }

    /// Protects callers that trace only after a change: two pairs differ if and only if an audible property differs.
    #[test]
    fn pairs_are_equal_if_they_sound_alike() {
        let before = scene(2, 2);
        let changed = |change: &dyn Fn(&mut Scene)| {
            let mut now = before.clone();
            change(&mut now);
            now.pair(0, 0).unwrap() != before.pair(0, 0).unwrap()
        };
        assert!(!changed(&|_| ()));
        assert!(!changed(&|scene| scene.sources[1].position.x += 1.0));
        assert!(!changed(&|scene| drop(scene.listeners.pop())));
        assert!(changed(&|scene| scene.sources[0].level_db = 1.0));
        assert!(changed(&|scene| scene.listeners[0].yaw = 1.0));
        assert!(changed(&|scene| scene.air = Some(Air::default())));
        assert!(changed(&|scene| scene.surfaces[0].position.z = 0.1));
        let brick = crate::scene::Material::builtin("brick").copied().unwrap();
        assert!(changed(&|scene| {
            scene.materials.insert("brick".into(), brick);
        }));
    }

    /// Protects the distance that a march evaluates: it includes the sphere of the pair's own listener only.
    #[test]
    fn the_distance_is_to_the_listener_of_the_pair() {
        let scene = scene(1, 2);
        let beside = Vec3::new(0.0, 2.0, 0.3);
        let [first, second] = [0, 1].map(|listener| scene.pair(0, listener).unwrap());
        assert_eq!(second.distance(beside).object, 0);
        assert!((second.distance(beside).distance - 0.2).abs() < 1e-6);
        assert!(first.distance(beside).distance > 0.9);
    }
}
