/* The C interface of echomarch::simulator. Written by cbindgen from bindings/c/src: do not edit. */

#ifndef ECHOMARCH_H
#define ECHOMARCH_H

#include <stddef.h>
#include <stdint.h>

/* World axes are right-handed: x to the right, y up, z towards the viewer. Lengths are in metres, times in seconds.
 * A pose without a rotation looks along -z. Bands are the octave bands of 63, 125, 250, 500 Hz, 1, 2, 4 and 8 kHz.
 *
 * A handle may be used by one thread at a time. EchomarchMix and EchomarchEars may be used by another thread than
 * their simulator, at the same time, and freed before or after it. Every function accepts NULL for a handle, and every
 * number may be NaN: then the function returns a status other than ECHOMARCH_STATUS_OK and changes nothing. */

/**
 * Number of octave bands: 63, 125, 250, 500 Hz, 1, 2, 4 and 8 kHz.
 */
#define ECHOMARCH_BANDS 8

/**
 * The id that a failed call writes. No object has it. 0 is an id like any other.
 */
#define ECHOMARCH_NO_ID UINT64_MAX

/**
 * The result of a call. `echomarch_simulator_error` has the text of the last one that is not ECHOMARCH_STATUS_OK.
 */
typedef enum {
  /**
   * Done.
   */
  ECHOMARCH_STATUS_OK = 0,
  /**
   * A handle or a place for a result is NULL.
   */
  ECHOMARCH_STATUS_NULL = 1,
  /**
   * A number is out of its range or not a number, or a text is not one of the scene format.
   */
  ECHOMARCH_STATUS_BAD_INPUT = 2,
  /**
   * There is no such source or surface: it was removed, or never added.
   */
  ECHOMARCH_STATUS_NO_OBJECT = 3,
  /**
   * There is no OpenGL that the simulator can use, or the system starts no thread.
   */
  ECHOMARCH_STATUS_NO_RENDERER = 4,
  /**
   * The source has no update: before its first round, and if it is removed or disabled.
   */
  ECHOMARCH_STATUS_NOT_YET = 5,
  /**
   * A fault in the library. The handle can be freed; its other results are not reliable.
   */
  ECHOMARCH_STATUS_FAULT = 6,
} EchomarchStatus;

/**
 * The state of a simulator's threads.
 */
typedef enum {
  /**
   * Updates are of the last commit's surfaces, or there was no commit yet.
   */
  ECHOMARCH_STATE_READY = 0,
  /**
   * Programs for the last commit's surfaces are compiled. Until they are ready, updates are of the surfaces before.
   */
  ECHOMARCH_STATE_COMPILING = 1,
  /**
   * The last commit's surfaces cannot be traced. Updates are of the surfaces before, if there are any.
   */
  ECHOMARCH_STATE_FAILED = 2,
} EchomarchState;

/**
 * The sound of one source as the listener hears it, for engines that mix sources themselves.
 */
typedef struct EchomarchEars EchomarchEars;

/**
 * The sound of all sources as the listener hears them.
 */
typedef struct EchomarchMix EchomarchMix;

/**
 * A world of sources, surfaces and a listener, whose sound is traced on threads of its own.
 */
typedef struct EchomarchSimulator EchomarchSimulator;

/**
 * Settings of a simulator: 64 bytes. `echomarch_default_settings` fills them.
 */
typedef struct {
  /**
   * Milliseconds that the simulator's thread works in each round, 0.5 to 1000.
   */
  double milliseconds;
  /**
   * Rounds per second, 1 to 1000.
   */
  double rounds_hz;
  /**
   * Length of a trace in seconds, 0.1 to 10.
   */
  double seconds;
  /**
   * Length in seconds of the traces that measure the decay, 0.1 to 20.
   */
  double longest_s;
  /**
   * Maximum number of waves of a trace, 64 to 65536.
   */
  uint32_t waves;
  /**
   * Maximum number of reflections of an echo, 0 to 8.
   */
  uint32_t order;
  /**
   * Maximum number of echoes of a source, 0 to 64.
   */
  uint32_t echoes;
  /**
   * Whether sound bends around what hides a source, 0 or 1.
   */
  uint32_t diffraction;
  /**
   * Whether sound passes solids whose materials transmit, 0 or 1.
   */
  uint32_t transmission;
  /**
   * 0. For later versions.
   */
  uint32_t reserved[3];
} EchomarchSettings;

/**
 * A position and an orientation in the world: 28 bytes.
 */
typedef struct {
  /**
   * World position in metres: x to the right, y up, z towards the viewer. Finite, within 1e9 m.
   */
  float position[3];
  /**
   * Quaternion (x, y, z, w) from the object's own axes to the world axes, of any length except 0. (0, 0, 0, 1)
   * looks along -z with +y up.
   */
  float rotation[4];
} EchomarchPose;

/**
 * What was heard of a source last: 416 bytes. Gains are amplitudes by octave band, relative to the direct sound of the
 * source at 1 m. Directions are unit vectors of the world towards the origin of the sound.
 */
typedef struct {
  /**
   * Gains of the direct way, with distance, directivity, level, air, diffraction and transmission.
   */
  double direct_gain[ECHOMARCH_BANDS];
  /**
   * The share of the energy that arrives on the direct way, of that in the open, 0 to 1.
   */
  double visibility;
  /**
   * Seconds from the source to the listener on the direct way.
   */
  double direct_delay_s;
  /**
   * Seconds from the source to the first sound, also if it is an echo.
   */
  double delay_s;
  /**
   * Seconds from the direct sound to the first reverberant sound.
   */
  double pre_delay_s;
  /**
   * Gains of all reverberation, echoes included: the root of its energy.
   */
  double reverb_gain[ECHOMARCH_BANDS];
  /**
   * Errors of these gains in decibels, one standard deviation.
   */
  double reverb_gain_error_db[ECHOMARCH_BANDS];
  /**
   * Decay times in seconds for 60 dB, at most 60; 0 where nothing reverberates.
   */
  double decay_s[ECHOMARCH_BANDS];
  /**
   * Errors of the decay times in seconds, one standard deviation.
   */
  double decay_error_s[ECHOMARCH_BANDS];
  /**
   * The number of the commit that the direct way belongs to.
   */
  uint64_t commit;
  /**
   * Number of traces of this source.
   */
  uint64_t traces;
  /**
   * Direction of the direct way.
   */
  float direct_from[3];
  /**
   * Direction of the first sound, also if it is an echo.
   */
  float from[3];
  /**
   * Whether the line from source to listener is free, 0 or 1.
   */
  uint32_t is_in_sight;
  /**
   * Number of waves of the last trace; 0 before the first.
   */
  uint32_t waves;
  /**
   * Number of echoes, also of those that the given array has no place for.
   */
  uint32_t echoes;
  /**
   * 0. For later versions.
   */
  uint32_t reserved;
  /**
   * Whether a part of the decay of a band lies beyond the traced record, 0 or 1.
   */
  uint8_t is_extrapolated[ECHOMARCH_BANDS];
} EchomarchUpdate;

/**
 * An echo, over a few reflections: 96 bytes.
 */
typedef struct {
  /**
   * Stays the same while the echo comes over the same surfaces and walls.
   */
  uint64_t key;
  /**
   * Amplitude by octave band, relative to the direct sound of the source at 1 m.
   */
  double gain[ECHOMARCH_BANDS];
  /**
   * Seconds from the source to the listener.
   */
  double delay_s;
  /**
   * Unit vector of the world towards the origin of the sound.
   */
  float from[3];
  /**
   * 0. For later versions.
   */
  uint32_t reserved;
} EchomarchEcho;

/**
 * The format of EchomarchMix and EchomarchEars: 24 bytes where pointers have 8. `echomarch_default_format` fills it.
 */
typedef struct {
  /**
   * Longest delay of a direct way or an echo in seconds, 0.01 to 5.
   */
  double longest_s;
  /**
   * A SOFA file with a head, for headphones; NULL for two loudspeakers. Read by `echomarch_mix_new` and
   * `echomarch_ears_new` only.
   */
  const char *head_file;
  /**
   * Samples per second, 8000 to 192000.
   */
  uint32_t rate_hz;
  /**
   * Maximum number of sources that are heard at once, 1 to 256. EchomarchEars have one.
   */
  uint32_t sources;
} EchomarchFormat;

/**
 * Fills `samples`, which are silent before, with the next `count` samples of a source. Called on the thread of
 * `echomarch_mix_process`, with its `user`. It must not throw or jump out.
 */
typedef void (*EchomarchFill)(void *user, uint64_t source, float *samples, size_t count);

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * The meaning of a status in English, for example of `echomarch_mix_process`, which leaves no text of its own. Never
 * NULL; the text is never freed.
 */
const char *echomarch_status_text(int32_t status);

/**
 * Fills settings with their defaults: 6 ms in each of 60 rounds a second, 4096 waves of 0.8 s.
 *
 * # Safety
 * `settings` is NULL, or memory for settings.
 */
EchomarchStatus echomarch_default_settings(EchomarchSettings *settings);

/**
 * Starts a simulator, and waits until it has an OpenGL context. `settings` may be NULL for the defaults. Writes the
 * handle to `sim`, or NULL if there is an error. `error` may be NULL; otherwise the text of an error is written to
 * its `error_size` bytes, cut if necessary, with a 0 at the end.
 *
 * # Safety
 * `settings` is NULL or points to settings; `sim` is NULL or memory for a pointer; `error` is NULL or memory for
 * `error_size` bytes.
 */
EchomarchStatus echomarch_simulator_new(const EchomarchSettings *settings,
                                        EchomarchSimulator **sim,
                                        char *error,
                                        size_t error_size);

/**
 * Ends a simulator, after the trace that is under way. NULL is allowed. Its EchomarchMix and EchomarchEars may still be
 * used: they play their last state.
 *
 * # Safety
 * `sim` is NULL, or a handle of `echomarch_simulator_new` that was not freed.
 */
void echomarch_simulator_free(EchomarchSimulator *sim);

/**
 * The text of the last error of a handle, in UTF-8. Empty before the first error and for NULL. Never NULL. Valid until
 * the next call with this handle.
 *
 * # Safety
 * `sim` is NULL, or a handle that was not freed.
 */
const char *echomarch_simulator_error(const EchomarchSimulator *sim);

/**
 * The name of the renderer. Empty for NULL. Valid until the handle is freed.
 *
 * # Safety
 * `sim` is NULL, or a handle that was not freed.
 */
const char *echomarch_simulator_renderer(const EchomarchSimulator *sim);

/**
 * Adds all objects of a scene file's text (docs/scene-format.md), and takes its materials, scattering and air. The
 * listener goes to the scene's first one. Objects before one at fault are added.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `text` is NULL or ends with 0.
 */
EchomarchStatus echomarch_add_scene(EchomarchSimulator *sim,
                                    const char *text);

/**
 * Sets a material by its name, by octave band (63 Hz to 8 kHz): the absorption coefficients and, unless `scattering`
 * is NULL, the scattering coefficients, 0 to 1. Built-in materials such as "brick" need no entry. A material that was
 * set before is replaced.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `name` is NULL or ends with 0; `absorption` and `scattering` are
 * NULL or point to eight numbers.
 */
EchomarchStatus echomarch_set_material(EchomarchSimulator *sim,
                                       const char *name,
                                       const double *absorption,
                                       const double *scattering);

/**
 * Adds a surface by a text in the scene format, for example
 * `Surface(shape: Box(size: (2, 3, 0.1)), position: (0, 1.5, -4), material: "door")`. Lengths are in metres, angles in
 * degrees. `turns` is 1 for a surface that will turn, so that its first turn compiles nothing, otherwise 0. Writes the
 * id to `id`, unless it is NULL.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `text` is NULL or ends with 0; `id` is NULL or memory for an id.
 */
EchomarchStatus echomarch_add_surface(EchomarchSimulator *sim,
                                      const char *text,
                                      uint32_t turns,
                                      uint64_t *id);

/**
 * Replaces the shape and the materials of a surface by those of a text in the scene format. Its pose stays. Other
 * numbers of the same shape compile nothing.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `text` is NULL or ends with 0.
 */
EchomarchStatus echomarch_set_surface(EchomarchSimulator *sim,
                                      uint64_t surface,
                                      const char *text);

/**
 * Moves and turns a surface.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `pose` is NULL or points to a pose.
 */
EchomarchStatus echomarch_place_surface(EchomarchSimulator *sim,
                                        uint64_t surface,
                                        const EchomarchPose *pose);

/**
 * Sets whether a surface is there: 0 or 1.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses.
 */
EchomarchStatus echomarch_enable_surface(EchomarchSimulator *sim,
                                         uint64_t surface,
                                         uint32_t is_enabled);

/**
 * Removes a surface. Its id is never that of another one.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses.
 */
EchomarchStatus echomarch_remove_surface(EchomarchSimulator *sim, uint64_t surface);

/**
 * Adds a source. `text` is NULL for a source of 0 dB that sounds alike in all directions; otherwise a text in the scene
 * format such as `Source(position: (0, 1, 0), level_db: -6, directivity: Cardioid)`. `pose` is NULL for the position
 * and the directions of the text, or of the origin. Writes the id to `id`, unless it is NULL.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `text` is NULL or ends with 0; `pose` is NULL or points to a
 * pose; `id` is NULL or memory for an id.
 */
EchomarchStatus echomarch_add_source(EchomarchSimulator *sim,
                                     const char *text,
                                     const EchomarchPose *pose,
                                     uint64_t *id);

/**
 * Moves and turns a source, also about its axis.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `pose` is NULL or points to a pose.
 */
EchomarchStatus echomarch_place_source(EchomarchSimulator *sim,
                                       uint64_t source,
                                       const EchomarchPose *pose);

/**
 * Sets the level of a source in decibels, -120 to 120 (0 at first), and its priority, above 0 and at most 1e6 (1 at
 * first): a source with twice the priority is traced about twice as often. If one of them is refused, both stay.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses.
 */
EchomarchStatus echomarch_set_source(EchomarchSimulator *sim,
                                     uint64_t source,
                                     float level_db,
                                     float priority);

/**
 * Sets whether a source sounds: 0 or 1. A source that does not sound takes no time and has no updates.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses.
 */
EchomarchStatus echomarch_enable_source(EchomarchSimulator *sim,
                                        uint64_t source,
                                        uint32_t is_enabled);

/**
 * Removes a source. Its id is never that of another one.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses.
 */
EchomarchStatus echomarch_remove_source(EchomarchSimulator *sim, uint64_t source);

/**
 * Places the listener.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `pose` is NULL or points to a pose.
 */
EchomarchStatus echomarch_place_listener(EchomarchSimulator *sim, const EchomarchPose *pose);

/**
 * Turns the head against the listener, for example by a head tracker: `rotation` has the four numbers of a quaternion
 * (x, y, z, w) of any length except 0, from the axes of the head to those of the listener. Heard in the next block of
 * each mix, without a commit.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `rotation` is NULL or points to four numbers.
 */
EchomarchStatus echomarch_turn_head(EchomarchSimulator *sim,
                                    const float *rotation);

/**
 * Hands the world to the simulator's threads. It does not wait. Writes the number of the commit, from 1, to `commit`,
 * unless it is NULL.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `commit` is NULL or memory for a number.
 */
EchomarchStatus echomarch_commit(EchomarchSimulator *sim,
                                 uint64_t *commit);

/**
 * Writes the state of the simulator's threads to `state`. If they have failed, `echomarch_simulator_error` has the
 * reason.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `state` is NULL or memory for a state.
 */
EchomarchStatus echomarch_state(EchomarchSimulator *sim,
                                EchomarchState *state);

/**
 * Writes 1 to `would_compile` if the world as it is now would have programs compiled aside if it were committed,
 * otherwise 0.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `would_compile` is NULL or memory for a number.
 */
EchomarchStatus echomarch_would_compile(EchomarchSimulator *sim,
                                        uint32_t *would_compile);

/**
 * Writes what was heard of a source last to `update`, and its first echoes, by delay, to the `capacity` places of
 * `echoes`. `echoes` may be NULL. ECHOMARCH_STATUS_NOT_YET before the source's first round, and if it is removed or
 * disabled.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `update` is NULL or memory for an update; `echoes` is NULL or
 * memory for `capacity` echoes.
 */
EchomarchStatus echomarch_update(EchomarchSimulator *sim,
                                 uint64_t source,
                                 EchomarchUpdate *update,
                                 EchomarchEcho *echoes,
                                 size_t capacity);

/**
 * Fills a format with its defaults: 64 sources, 0.6 s, two loudspeakers.
 *
 * # Safety
 * `format` is NULL, or memory for a format.
 */
EchomarchStatus echomarch_default_format(uint32_t rate_hz, EchomarchFormat *format);

/**
 * Makes a mix of all sources. Writes the handle to `mix`, or NULL if there is an error.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `format` is NULL or points to a format; `mix` is NULL or memory
 * for a pointer.
 */
EchomarchStatus echomarch_mix_new(EchomarchSimulator *sim,
                                  const EchomarchFormat *format,
                                  EchomarchMix **mix);

/**
 * Overwrites `stereo`, `frames` pairs of left and right, with the next samples. `fill` is called for each source that
 * is heard, several times if there are more than 128 frames; NULL plays silence into the mix. Samples that are not
 * numbers count as 0. Neither allocates, frees nor locks.
 *
 * # Safety
 * `mix` is NULL or a handle that no other thread uses; `stereo` is NULL or memory for 2 * `frames` samples; `fill` is
 * NULL or a function that keeps to its place.
 */
EchomarchStatus echomarch_mix_process(EchomarchMix *mix,
                                      float *stereo,
                                      size_t frames,
                                      EchomarchFill fill,
                                      void *user);

/**
 * Frees a mix, before or after its simulator, while no thread uses it. NULL is allowed.
 *
 * # Safety
 * `mix` is NULL, or a handle of `echomarch_mix_new` that was not freed.
 */
void echomarch_mix_free(EchomarchMix *mix);

/**
 * Makes the ears of one source. Writes the handle to `ears`, or NULL if there is an error.
 *
 * # Safety
 * `sim` is NULL or a handle that no other thread uses; `format` is NULL or points to a format; `ears` is NULL or memory
 * for a pointer.
 */
EchomarchStatus echomarch_ears_new(EchomarchSimulator *sim,
                                   uint64_t source,
                                   const EchomarchFormat *format,
                                   EchomarchEars **ears);

/**
 * Overwrites `stereo`, `frames` pairs of left and right, with what is heard of the next `frames` samples of the source.
 * Samples that are not numbers count as 0. Neither allocates, frees nor locks.
 *
 * # Safety
 * `ears` is NULL or a handle that no other thread uses; `mono` is NULL or points to `frames` samples, and `stereo` is
 * NULL or memory for 2 * `frames` samples, which do not overlap.
 */
EchomarchStatus echomarch_ears_process(EchomarchEars *ears,
                                       const float *mono,
                                       float *stereo,
                                       size_t frames);

/**
 * Frees ears, before or after their simulator, while no thread uses them. NULL is allowed.
 *
 * # Safety
 * `ears` is NULL, or a handle of `echomarch_ears_new` that was not freed.
 */
void echomarch_ears_free(EchomarchEars *ears);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ECHOMARCH_H */
