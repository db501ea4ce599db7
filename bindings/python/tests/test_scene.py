"""Scenes: construction, materials, axes, copies, refusals."""

import copy
import pickle

import numpy as np
import pytest

import echomarch as em
from conftest import SCENES

CHEAP = {"waves": 1024, "seconds": 0.8}


def test_axes_of_pyfar_are_converted(room):
    """Protects users of pyfar: a room given in its axes has the same sound, and its results are in its axes."""
    np.testing.assert_array_equal(em.to_pyfar([1, 2, 3]), [-3, -1, 2])
    np.testing.assert_array_equal(em.from_pyfar(em.to_pyfar([[1, 2, 3]])), [[1, 2, 3]])
    one = em.Scene.shoebox((8, 3, 5), {"floor": "carpet", "left": 0.5})
    one.add_source("s", (-2, 0.5, -1.5))
    one.add_listener("l", (2, -0.3, 1.5), view=(1, 0, 0))
    # Depth, width, height; x ahead, y to the left, z up.
    other = em.Scene.shoebox((5, 8, 3), {"floor": "carpet", "left": 0.5}, axes="pyfar")
    other.add_source("s", (1.5, 2, 0.5))
    other.add_listener("l", (-1.5, -2, -0.3), view=(0, -1, 0))
    assert other.sources == {"s": (1.5, 2.0, 0.5)}
    ours, theirs = em.response(one, **CHEAP), em.response(other, **CHEAP)
    assert ours == theirs
    np.testing.assert_array_equal(theirs.paths["direction"], em.to_pyfar(ours.paths["direction"]))
    np.testing.assert_array_equal(theirs.echogram["flow"], em.to_pyfar(ours.echogram["flow"]))
    np.testing.assert_array_equal(theirs.path_points[3], em.to_pyfar(ours.path_points[3]))
    assert theirs.source_position == (1.5, 2.0, 0.5)
    # The source is ahead and to the left of a listener that looks to +x: its view is the listener's.
    assert ours.paths["azimuth_deg"][0] == theirs.paths["azimuth_deg"][0] < 0
    with pytest.raises(em.SettingsError, match="there are no axes 'blender'"):
        em.Scene("corner", axes="blender")


def test_materials_are_one_number_or_eight_or_a_name(room):
    """Protects materials: each notation gives the energy that it states."""

    def level(absorption, **more):
        room = em.Scene.shoebox((8, 3, 5), absorption, **more)
        room.add_source("s", (-2, 0, -1.5))
        room.add_listener("l", (2, -0.3, 1.5))
        return em.response(room, **CHEAP).figures["g"]

    one = level(0.2)
    np.testing.assert_array_equal(one, level([0.2] * 8))
    np.testing.assert_array_equal(one, level(np.full(8, 0.2)))
    np.testing.assert_array_equal(one, level(em.Material(0.2)))
    np.testing.assert_array_equal(one, level({wall: 0.2 for wall in em.WALLS}))
    assert np.all(level(0.4) < one) and np.all(level(0.15) > one)
    carpet = level("mineral-wool")
    assert carpet[0] > carpet[7]
    np.testing.assert_array_equal(carpet, level(em.builtin_materials()["mineral-wool"]))
    assert not np.array_equal(one, level(0.2, scattering=0.5))
    np.testing.assert_array_equal(level(0.2, scattering=0.5), level(em.Material(0.2, 0.5)))


def test_unknown_materials_are_refused_at_once(room):
    """Protects from a wrong name that is found only when the room is traced; the message suggests a name."""
    before = room.to_ron()
    with pytest.raises(em.SceneError, match="there is no material \"carpett\".*carpet"):
        room.set_material("room", "carpett")
    with pytest.raises(em.SceneError, match=r"did you mean wood-floor or wood-panel\?"):
        room.set_material("room", "wood")
    with pytest.raises(em.SceneError, match="there is no material"):
        em.Scene.shoebox((8, 3, 5), {"floor": 'a "felt"'})
    with pytest.raises(em.SceneError, match="there is no material"):
        room.add_surface("Sphere(radius: 0.5)", material="carpett")
    with pytest.raises(em.EchomarchError, match="absorption"):
        room.add_surface("Sphere(radius: 0.5)", material=-0.1)
    assert room.to_ron() == before
    room.add_material('a "felt"', 0.4)
    room.set_material("room", 'a "felt"', part="floor")


def test_scattering_holds_for_materials_that_state_none(room):
    """Protects the scattering of a scene: it may be set before or after the materials."""
    room.scattering = [0.1] * 8
    before = em.Scene.shoebox((8, 3, 5), 0.1, 0.1)
    for wall, material in {"floor": "carpet", "ceiling": 0.6, "left": 0.2, "right": 0.3, "back": 0.2}.items():
        before.set_material("room", material, part=wall)
    before.add_source("talker", (-2, 0, -1.5))
    before.add_listener("seat", (2, -0.3, 1.5), yaw=30)
    assert em.response(room, **CHEAP) == em.response(before, **CHEAP)
    with pytest.raises(em.SettingsError, match="scattering must be one share of 0 to 1, or 8 for the octave bands"):
        room.scattering = [0.1, 0.2, 0.3]


@pytest.mark.parametrize("scattering", [-1, 1.5, float("nan"), "x", None, [0.1] * 3, [[0.1], [0.2, 0.3]], [0.1] * 7 + [2]])
def test_a_refused_change_leaves_the_scene_as_it_was(room, scattering):
    """Protects a scene from half a change: scattering, values and materials are changed as a whole or not at all."""
    room.add_surface('Box(size: (0.1, 2, Value("door", 0.9)))', (1, -0.5, 0), material=0.3, name="door")
    before, calls = room.to_ron(), list(room._calls)
    with pytest.raises(em.SettingsError, match="scattering must be one share of 0 to 1, or 8 for the octave bands"):
        room.scattering = scattering
    with pytest.raises(em.SettingsError, match="the value door must be a number"):
        room.set(door="wide")
    with pytest.raises(em.SceneError, match='has no value named "dor"'):
        room.set(door=0.5, dor=1)
    with pytest.raises(em.SettingsError, match='has no part "flor".*did you mean floor?'):
        room.set_material("room", 0.4, part="flor")
    with pytest.raises(em.SceneError, match=r"the material door \(2\): an absorption must be 0 to 1, not 2"):
        room.set_material("door", 2)
    with pytest.raises(em.SceneError, match="temperature"):
        room.set_air(200)
    assert room.scattering == 0.0 and room.to_ron() == before and room._calls == calls


def test_surfaces_sources_and_listeners_are_removed(room):
    """Protects removals: by name or number, also in copies in other processes, and an unknown name is refused."""
    before = room.to_ron()
    room.add_surface("Sphere(radius: 0.5)", material="carpet", name="ball")
    room.add_source("piano", (0, 0, -2))
    room.add_listener("row", (1, 0, 1))
    with pytest.raises(em.SettingsError, match='has no surface "bal"; it has: room, ball; did you mean ball?'):
        room.remove_surface("bal")
    with pytest.raises(em.SettingsError, match='has no source "pino"; it has: talker, piano; did you mean piano?'):
        room.remove_source("pino")
    with pytest.raises(em.SettingsError, match='has no source "pino"; it has: talker, piano; did you mean piano?'):
        em.response(room, "pino")
    with pytest.raises(em.SettingsError, match='has no listener "3"; it has: seat, row'):
        room.remove_listener(3)
    for remove in (room.remove_surface, room.remove_source, room.remove_listener):
        with pytest.raises(em.SettingsError, match="must be the name or the number of a [a-z]*, not None"):
            remove(None)
    copied = pickle.loads(pickle.dumps(room))
    room.remove_surface("ball")
    room.remove_source("piano")
    room.remove_listener(2)
    assert room.to_ron() == before == pickle.loads(pickle.dumps(room)).to_ron()
    assert copied.surfaces == ["room", "ball"] and list(copied.sources) == ["talker", "piano"]
    with pytest.raises(em.SettingsError, match='has no source "drum"; it has none'):
        em.Scene.empty().remove_source("drum")


def test_a_number_that_another_surface_had_keeps_its_material():
    """Protects materials after a removal: a surface without a name does not take over the material of another."""
    scene = em.Scene.empty()
    for absorption in (0.1, 0.2):
        scene.add_surface("Sphere(radius: 0.5)", material=absorption)
    scene.remove_surface(1)
    scene.add_surface("Sphere(radius: 0.5)", material=0.3)
    scene.add_source("s", (0, 2, 0))
    scene.add_listener("l", (2, 0, 0))
    text = "".join(scene.to_ron().split())
    assert 'material:Some("2")' in text.replace('material:"2"', 'material:Some("2")') and '"2(2)"' in text, text
    assert "absorption:0.2" in text and "absorption:0.3" in text, text


def test_offered_parts_are_accepted():
    """Protects from names that are offered but refused: a wall that another box covers has no faces."""
    scene = em.Scene.empty("niche")
    boxes = 'Rooms(of: [(name: "hall", from: (0, 0, 0), to: (6, 3, 4)), (name: "nook", from: (1, 0, 4), to: (3, 2, 5))])'
    scene.add_surface(boxes, material="plaster", name="room")
    scene.add_source("talker", (5, 1.6, 1))
    scene.add_listener("seat", (2, 1, 4.5))
    with pytest.raises(em.SettingsError, match='has no part "nook/front"; it has: ') as refused:
        scene.set_material("room", "carpet", part="nook/front")
    names = str(refused.value).split("it has: ")[1].split("; did you mean")[0].split(", ")
    assert "nook/back" in names and "hall/back" in names and "nook/front" not in names
    for name in names:
        scene.set_material("room", "carpet", part=name)
    scene.check()


def test_a_room_in_millimetres_is_a_warning():
    """Protects newcomers from a wrong unit."""
    room = em.Scene.shoebox((8000, 3000, 5000), 0.2)
    assert room.warnings == [
        "surface 1 (room): it is 8000 m long: if its unit is not the metre, state its lengths in metres"
    ]


def test_parts_of_rooms_have_materials():
    """Protects joined rooms: a box, one of its walls, and a wall of all boxes get a material as in a scene file."""
    boxes = 'Rooms(of: [(name: "long", from: (0, 0, 0), to: (7, 2.8, 3)), (name: "short", from: (0, 0, 3), to: (3, 2.8, 6)), (from: (0, 0, 6), to: (3, 2.8, 8))])'
    for part, written in {
        "short": 'faces: {"short": "carpet"}',
        "short/floor": 'faces: {"short/floor": "carpet"}',
        "floor": 'walls: Walls(floor: "carpet")',
        "3": 'faces: {"3": "carpet"}',
    }.items():
        scene = em.Scene.empty("L")
        scene.add_surface(boxes, material="plasterboard", name="room")
        scene.add_source("talker", (6, 1.6, 1))
        scene.add_listener("seat", (1, 1.2, 5))
        scene.set_material("room", "carpet", part=part)
        flat = "".join(scene.to_ron().split())
        assert written.replace(" ", "") in flat.replace(",)", ")").replace(",}", "}"), flat
        with pytest.raises(em.SettingsError, match="has no part \"cellar\"; it has: "):
            scene.set_material("room", "carpet", part="cellar")


def test_air_changes_speed_and_losses(room):
    """Protects the air: cold air is slower, and removing it restores the first result."""
    without = em.response(room, **CHEAP)
    room.set_air(-10, 30)
    assert room.speed_of_sound < 330
    cold = em.response(room, **CHEAP)
    assert cold.time_origin_s > without.time_origin_s and cold.figures["g"][7] < without.figures["g"][7]
    room.set_air(None)
    assert em.response(room, **CHEAP) == without


def test_copies_and_pickles_have_the_same_bits(room):
    """Protects workers: a scene in another process is the same, whatever it was made of."""
    room.add_surface('Box(size: (0.1, 2, Value("door", 0.9)))', (1, -0.5, 0), (0, 33.3, 0), "door", name="door")
    room.set(door=0.7)
    first = em.response(room, **CHEAP)
    for copied in (copy.copy(room), copy.deepcopy(room), pickle.loads(pickle.dumps(room)), room.at(0.0)):
        assert em.response(copied, **CHEAP) == first
    copied = room.copy()
    copied.set_value("door", 0.2)
    assert room.values == {"door": pytest.approx(0.7)} and copied.values == {"door": pytest.approx(0.2)}
    assert em.response(copied, **CHEAP) != first
    with pytest.raises(em.SceneError, match='has no value named "dor"; it has: door; did you mean door'):
        room.set(dor=1)


def test_meshes_are_read_with_their_groups(room, tmp_path):
    """Protects meshes: groups have materials, a mesh whose z axis points up is turned, defects are warned of."""
    scene = em.Scene.from_mesh(SCENES / "attic.obj", materials=None, absorption=0.3)
    assert scene.surfaces == ["mesh"] and scene.materials == ["mesh"]
    with pytest.raises(em.SettingsError, match='has no group "nothing"; it has: '):
        em.Scene.from_mesh(SCENES / "attic.obj", materials={"nothing": 0.1})
    # A cube of 2 m whose face ahead (+y of the file) has a material of its own; one face is missing.
    cube = tmp_path / "cube.obj"
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = {"left": "1 2 4 3", "right": "5 7 8 6", "back": "1 5 6 2", "ahead": "3 4 8 7", "floor": "1 3 7 5"}
    lines = ["v %g %g %g" % corner for corner in corners]
    lines += [f"usemtl {name}\nf {face}" for name, face in faces.items()]
    cube.write_text("\n".join(lines))
    with pytest.warns(UserWarning, match="cube.obj"):
        turned = em.Scene.from_mesh(cube, materials={"ahead": 0.9}, inside="air", up="z")
    assert turned.distance((0, 0, -0.9)) == pytest.approx(0.1, abs=1e-5)
    turned.add_source("s", (0.2, 0, 0))
    turned.add_listener("l", (-0.2, 0, 0.1), radius=0.05)
    r = em.response(turned, waves=1024, seconds=0.02)
    ahead = [index for index, names in enumerate(r.path_surfaces) if names == ("mesh/ahead",)]
    assert len(ahead) == 1
    np.testing.assert_allclose(r.path_points[ahead[0]][0, 2], -1.0, atol=1e-5)


def test_sources_have_directions_and_levels():
    """Protects sources: level, directivity and view change what is heard, as stated."""

    def heard(**settings):
        scene = em.Scene.shoebox((8, 3, 5), 0.2)
        scene.add_source("s", (-2, 0, 0), **settings)
        scene.add_listener("l", (2, 0, 0))
        return em.response(scene, **CHEAP).paths["g_db"][0]

    assert heard(level_db=6) - heard() == pytest.approx(6.0, abs=1e-4)
    at, away = (heard(directivity="Cardioid", view=view) for view in ((1, 0, 0), (0, 0, 1)))
    assert at - away == pytest.approx(20 * np.log10(2), abs=1e-3)
    assert at == heard(directivity="Cardioid", yaw=90)


@pytest.mark.parametrize(
    "make, sentence",
    [
        (lambda: em.Scene.shoebox((1, 2)), "the size of a room must be three numbers, lengths in m, not (1, 2)"),
        (lambda: em.Scene.shoebox(4), "the size of a room must be three numbers, lengths in m, not 4"),
        (lambda: em.Scene.shoebox((1, 2, 3), {"floor": None}), "absorption must be a share of 0 to 1, or 8"),
        (lambda: em.Scene.shoebox((1, 2, 3), em.Material(0.1, density="x")), "density must be a density in kg/m³"),
        (lambda: em.Material(20), "the material: an absorption must be 0 to 1, not 20"),
        (lambda: em.Material(0.2, reduction=40), "thickness"),
        (lambda: em.write_sofa("a.wav", []), "file must be a path that ends in .sofa, not 'a.wav'"),
        (lambda: em.Scene("shoebox").add_surface("Plane", name="room"), 'already has a surface "room"'),
        (lambda: em.Scene.shoebox((1, 2, -3)), "three lengths above 0 m"),
        (lambda: em.Scene.shoebox((1, 2, 3), 1.5), "the material room: an absorption must be 0 to 1, not 1.5"),
        (lambda: em.Scene.shoebox((1, 2, 3), [0.1] * 7), "8"),
        (lambda: em.Scene.shoebox((1, 2, 3), float("nan")), "absorption"),
        (lambda: em.Scene.shoebox((1, 2, 3), {"roof": 0.1}), "has no part \"roof\"; it has: left, right, floor"),
        (lambda: em.Scene.empty().set_material("wall", 0.1), 'has no surface "wall"; it has none'),
        (lambda: em.Scene.empty().add_surface("Bx"), "did you mean Box?"),
        (lambda: em.Scene.empty().add_source("s", "ab"), "the position of a source must be three numbers"),
        (lambda: em.Scene.empty().add_source("s", (1, 2)), "three numbers, coordinates in m, not (1, 2)"),
        (lambda: em.Scene.empty().add_source(1, (0, 0, 0)), "name must be a text, not 1"),
        (lambda: em.Scene.empty().add_source("s", (0, 0, 0), level_db="x"), "level_db must be a level in dB, not 'x'"),
        (lambda: em.Scene.empty().add_source("s", (0, 0, 0), directivity=1), "directivity must be a text in the not"),
        (lambda: em.Scene.empty().add_listener("l", (0, 0, 0), yaw=None), "yaw must be an angle in degrees, not None"),
        (lambda: em.Scene.empty().add_listener("l", (0, 0, 0), view=3), "view must be three numbers, a direction, not 3"),
        (lambda: em.Scene.empty().add_surface("Box(size: (1, 1, 1))", (0, 0)), "the position of a surface must be thr"),
        (lambda: em.Scene("corner").at("now"), "seconds must be a time in s, not 'now'"),
        (lambda: em.Scene.empty().set_air("warm"), "temperature must be a number of °C, not 'warm'"),
        (lambda: em.response("hall"), "scene must be a Scene, not 'hall'"),
        (lambda: em.responses(["hall"]), "scene must be a Scene, not 'hall'"),
        (lambda: em.responses([em.Scene("corner")], workers=1.5), "workers must be a whole number of processes, not 1.5"),
        (lambda: em.Scene(5), "the name or file of a scene must be a path, not 5"),
        (lambda: em.Scene(None), "the name or file of a scene must be a path, not None"),
        (lambda: em.Scene("corner", axes=["pyfar"]), "there are no axes ['pyfar']: use echomarch or pyfar"),
        (lambda: em.Scene.from_ron(5), "text must be the text of a scene file, not 5"),
        (lambda: em.Scene.from_ron("Scene()", folder=5), "folder must be a path, not 5"),
        (lambda: em.Scene.empty(None), "name must be a text, not None"),
        (lambda: em.Scene.shoebox("a"), "the size of a room must be three numbers, lengths in m, not 'a'"),
        (lambda: em.Scene.shoebox((1, 2, 3), [[0.1], [0.1, 0.2]]), "absorption must be a share of 0 to 1, or 8"),
        (lambda: em.Scene.shoebox((1, 2, 3), {1: 0.1}), "absorption must be a material, or a dictionary of materials"),
        (lambda: em.Scene.from_mesh(5), "file must be a path, not 5"),
        (lambda: em.Scene.from_mesh("a.obj", materials=5), "materials must be a dictionary of materials by the names"),
        (lambda: em.Scene.from_mesh("a.obj", inside=["air"]), "inside must be air or solid, not ['air']"),
        (lambda: em.Scene.from_mesh(SCENES / "attic.obj", scale="x"), "scale must be a number of m, not 'x'"),
        (lambda: em.Scene.empty().add_surface(5), "shape must be a text in the notation of scene files, not 5"),
        (lambda: em.Scene.empty().add_surface("Plane", None), "the position of a surface must be three numbers"),
        (lambda: em.Scene.empty().add_surface("Plane", ("0", 1)), "the position of a surface must be three numbers"),
        (lambda: em.Scene.empty().add_surface("Plane", rotation=5), "the rotation of a surface must be three numbers"),
        (lambda: em.Scene.empty().add_surface("Plane", rotation=(1, 2)), "the rotation of a surface must be three num"),
        (lambda: em.Scene.empty().add_surface("Plane", name=5), "name must be a text, not 5"),
        (lambda: em.Scene.empty().add_surface("Plane", folder=5), "folder must be a path, not 5"),
        (lambda: em.Scene.empty().add_surface("Plane", material=object()), "absorption must be a share of 0 to 1"),
        (lambda: em.Scene.empty().add_material(5, 0.1), "the name of a material must be a text, not 5"),
        (lambda: em.Scene.empty().set_material(None, 0.1), "surface must be the name or the number of a surface"),
        (lambda: em.Scene("corner").set_material("1", 0.1, part=2), "part must be the name of a part of the surface"),
        (lambda: em.Scene.empty().add_source("s", None), "the position of a source must be three numbers"),
        (lambda: em.Scene.empty().add_source("s", (0, 0, 0), folder=5), "folder must be a path, not 5"),
        (lambda: em.Scene.empty().add_listener("l", (0, 0, 0), radius="x"), "radius must be a length in m, not 'x'"),
        (lambda: em.Scene.empty().set_air(20, "wet"), "humidity must be a number of per cent, not 'wet'"),
        (lambda: em.Scene.empty().set_value(5, 1), "name must be the name of a value, not 5"),
        (lambda: em.Scene("corner").distance(5), "a point must be three numbers, coordinates in m, not 5"),
        (lambda: em.Scene("corner").save(5), "file must be a path, not 5"),
        (lambda: em.response(None), "scene must be a Scene, not None"),
        (lambda: em.responses(5), "items must be a list of scenes or of (scene, source, listener)"),
        (lambda: em.responses(em.Scene("corner")), "items must be a list of scenes or of (scene, source, listener)"),
        (lambda: em.responses([(em.Scene("corner"),)]), "an item must be a scene or (scene, source, listener)"),
        (lambda: em.response(em.Scene("corner"), accuracy="2%"), "accuracy must be a share, such as 0.02 for 2 %"),
        (lambda: em.responses([em.Scene("corner")], acuracy=1), 'there is no setting "acuracy"; there are: accuracy'),
        (lambda: em.responses([em.Scene("corner")], worker=2), "did you mean workers?"),
        (lambda: em.trace(5), "scene must be a Scene, not 5"),
        (lambda: em.trace(em.Scene("corner"), waves="x"), "waves must be a whole number of waves, not 'x'"),
        (lambda: em.trace(em.Scene("corner"), waves=None), "waves must be a whole number of waves, not None"),
        (lambda: em.write_sofa("a.sofa", 5), "responses must be a list of responses, not 5"),
        (lambda: em.write_sofa("a.sofa", [5]), "responses must be a list of responses, not [5]"),
        (lambda: em.write_sofa(5, []), "file must be a path, not 5"),
        (lambda: em.Study(5), "file must be a path, not 5"),
        (lambda: em.use_renderer(5), "gl must be the name of an OpenGL interface, not 5"),
        (lambda: em.use_renderer(gpu="x"), "gpu must be the number of a device, from 0, not 'x'"),
        (lambda: em.to_pyfar([1, 2]), "vectors must be an array of numbers with 3 columns, not [1, 2]"),
        (lambda: em.from_pyfar("x"), "vectors must be an array of numbers with 3 columns, not 'x'"),
        (lambda: em.Scene.empty().add_source("s", (0, 0, float("inf"))), "position"),
        (lambda: em.Scene.empty().add_source("s", (0, 0, 0), directivity="Loud"), "Loud"),
        (lambda: em.Scene.empty().add_source("s", (0, 0, 0), view=(0, 0, 0)), "must not be (0, 0, 0)"),
        (lambda: em.Scene.empty().add_listener("l", (0, 0, 0), radius=-1), "radius"),
        (lambda: em.Scene.from_ron("Scene("), "text:1"),
        (lambda: em.Scene.from_mesh("none.obj"), "the mesh none.obj"),
        (lambda: em.response(em.Scene.empty()), "the scene has no source: add one with add_source"),
        (lambda: em.response(em.Scene("corner"), "drum"), 'has no source "drum"; it has: 1'),
    ],
)
def test_bad_scenes_are_refused_in_sentences(make, sentence):
    """Protects users from tracebacks: every bad argument is a ValueError with a sentence."""
    with pytest.raises(ValueError) as refused:
        make()
    assert isinstance(refused.value, em.EchomarchError)
    assert sentence in str(refused.value), refused.value


def test_two_listeners_or_sources_of_one_name_are_refused(room):
    """Protects listeners from hiding each other: a second one of the same name is refused, as in a scene file."""
    for add, what, name in ((room.add_listener, "listeners", "seat"), (room.add_source, "sources", "talker")):
        with pytest.raises(em.SceneError, match=f'two of the {what} are called "{name}"'):
            add(name, (0, 0, 0))
    assert list(room.listeners) == ["seat"] and list(room.sources) == ["talker"]
    room.add_source("seat", (0, 0, 0))
    em.response(room.copy(), "talker", **CHEAP)


def test_places_read_as_they_were_given(room):
    """Protects places from the digits of 32-bit numbers: 1.6 does not read 1.600000023841858."""
    room.add_listener("row", (1.6, -0.3, 0.7))
    assert room.listeners["row"] == (1.6, -0.3, 0.7)


def test_pairs_are_chosen_by_name_or_number(room):
    """Protects scenes with several sources: one must be chosen, by its name or its number."""
    room.add_source("piano", (0, 0, -2))
    with pytest.raises(em.SettingsError, match=r"the scene has 2 sources \(talker, piano\): choose one with source="):
        em.response(room, **CHEAP)
    assert em.response(room, "piano", **CHEAP) == em.response(room, 2, **CHEAP)
    assert [item[1:] for item in room.pairs()] == [("talker", "seat"), ("piano", "seat")]
    room.clear_sources()
    room.clear_listeners()
    assert room.sources == room.listeners == {}


def test_misspelt_attributes_are_refused(room):
    """Protects users from settings without effect: an attribute that a scene lacks cannot be set."""
    for name in ("scatering", "air", "seconds"):
        with pytest.raises(AttributeError, match=f"no attribute '{name}'"):
            setattr(room, name, 0.2)
    room.scattering = 0.2
    assert copy.copy(room).scattering == 0.2


def test_materials_keep_the_names_of_others(room):
    """Protects built-in and added materials: a surface with the same name gets a material of another name."""
    room.add_material("2", 0.7)
    room.add_surface("Sphere(radius: 0.5)", (1, 0, 0), material=0.5)
    room.add_surface("Sphere(radius: 0.4)", (-1, 0, 0), material=0.5, name="carpet")
    room.add_surface("Sphere(radius: 0.3)", (0, 0, 1), material="carpet")
    text = " ".join(room.to_ron().split())
    assert '"2": Material( absorption: 0.7' in text and '"2 (2)": Material( absorption: 0.5' in text
    assert text.count('material: "carpet"') == 1
    # A material of its own is replaced, also with the changed name.
    room.set_material("carpet", 0.25)
    assert room.to_ron().count("carpet (2)") == text.count("carpet (2)")
