/* Tests of the C interface: what it does, and that it refuses bad inputs. Run by scripts/c-test.sh with the address, leak
 * and undefined behaviour sanitizers. */
#include "echomarch.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define OK ECHOMARCH_STATUS_OK
#define LIMIT_S 60
#define FRAMES 300

_Static_assert(sizeof(EchomarchPose) == 28, "the documented size of EchomarchPose");
_Static_assert(sizeof(EchomarchSettings) == 64, "the documented size of EchomarchSettings");
_Static_assert(sizeof(EchomarchUpdate) == 416, "the documented size of EchomarchUpdate");
_Static_assert(sizeof(EchomarchEcho) == 96, "the documented size of EchomarchEcho");

static int failures;
static EchomarchSimulator *sim;

#define EXPECT(condition)                                                                                  \
    do {                                                                                                   \
        if (!(condition)) {                                                                                \
            failures++;                                                                                    \
            fprintf(stderr, "%s:%d: not so: %s (last error: %s)\n", __FILE__, __LINE__, #condition,        \
                    echomarch_simulator_error(sim));                                                       \
        }                                                                                                  \
    } while (0)

/* Whether the call is refused with this status and a text that contains `words`. */
#define REFUSED(status, words, call)                                                                       \
    do {                                                                                                   \
        EXPECT((call) == (status));                                                                        \
        EXPECT(strstr(echomarch_simulator_error(sim), words) != NULL);                                     \
    } while (0)

static const EchomarchPose HERE = {{1, 0, -1}, {0, 0, 0, 1}};
static const EchomarchPose NOWHERE = {{NAN, 0, 0}, {0, 0, 0, 1}};
static const EchomarchPose UNTURNED = {{0, 0, 0}, {0, 0, 0, 0}};
static const char ROOM[] = "Surface(shape: Room(size: (6, 3, 5)), material: \"carpet of mine\")";
static const char BOX[] = "Surface(shape: Box(size: (0.5, 3, 0.5)), position: (-1, 0, -1), material: \"brick\")";

static void rest(void) {
    nanosleep(&(struct timespec){0, 2000000}, NULL);
}

static void test_nothing(void) {
    EchomarchSimulator *none = NULL;
    EchomarchUpdate update;
    EchomarchState state;
    uint64_t id;
    uint32_t answer;
    const EchomarchStatus NO = ECHOMARCH_STATUS_NULL;
    EXPECT(echomarch_simulator_new(NULL, NULL, NULL, 0) == NO);
    EXPECT(echomarch_default_settings(NULL) == NO);
    EXPECT(echomarch_default_format(48000, NULL) == NO);
    EXPECT(echomarch_add_scene(none, "") == NO);
    EXPECT(echomarch_set_material(none, "", NULL, NULL) == NO);
    EXPECT(echomarch_add_surface(none, ROOM, 0, &id) == NO);
    EXPECT(echomarch_set_surface(none, 0, ROOM) == NO);
    EXPECT(echomarch_place_surface(none, 0, &HERE) == NO);
    EXPECT(echomarch_enable_surface(none, 0, 1) == NO);
    EXPECT(echomarch_remove_surface(none, 0) == NO);
    EXPECT(echomarch_add_source(none, NULL, &HERE, &id) == NO);
    EXPECT(echomarch_place_source(none, 0, &HERE) == NO);
    EXPECT(echomarch_set_source(none, 0, 0, 1) == NO);
    EXPECT(echomarch_enable_source(none, 0, 1) == NO);
    EXPECT(echomarch_remove_source(none, 0) == NO);
    EXPECT(echomarch_place_listener(none, &HERE) == NO);
    EXPECT(echomarch_turn_head(none, HERE.rotation) == NO);
    EXPECT(echomarch_commit(none, NULL) == NO);
    EXPECT(echomarch_state(none, &state) == NO);
    EXPECT(echomarch_would_compile(none, &answer) == NO);
    EXPECT(echomarch_update(none, 0, &update, NULL, 0) == NO);
    EXPECT(echomarch_mix_new(none, NULL, NULL) == NO);
    EXPECT(echomarch_ears_new(none, 0, NULL, NULL) == NO);
    EXPECT(echomarch_mix_process(NULL, NULL, 0, NULL, NULL) == NO);
    EXPECT(echomarch_ears_process(NULL, NULL, NULL, 0) == NO);
    EXPECT(strcmp(echomarch_simulator_error(none), "") == 0);
    EXPECT(strcmp(echomarch_simulator_renderer(none), "") == 0);
    EXPECT(strlen(echomarch_status_text(NO)) > 0 && strlen(echomarch_status_text(-1)) > 0);
    echomarch_simulator_free(NULL);
    echomarch_mix_free(NULL);
    echomarch_ears_free(NULL);
}

static void test_settings(void) {
    EchomarchSettings settings;
    EchomarchSimulator *none = (EchomarchSimulator *)&settings;
    char error[40] = "";
    EXPECT(echomarch_default_settings(&settings) == OK);
    settings.milliseconds = NAN;
    EXPECT(echomarch_simulator_new(&settings, &none, error, sizeof error) == ECHOMARCH_STATUS_BAD_INPUT);
    EXPECT(none == NULL && strstr(error, "milliseconds") != NULL && strlen(error) == sizeof error - 1);
    EXPECT(echomarch_simulator_new(&settings, &none, error, 0) == ECHOMARCH_STATUS_BAD_INPUT);
    EXPECT(echomarch_default_settings(&settings) == OK);
    settings.waves = 1024;
    settings.seconds = settings.longest_s = 0.3;
    EXPECT(echomarch_simulator_new(&settings, &sim, error, sizeof error) == OK);
    EXPECT(strcmp(error, "") == 0);
    if (sim == NULL) {
        exit(1);
    }
    printf("renderer: %s\n", echomarch_simulator_renderer(sim));
}

static void test_bad_inputs(void) {
    const EchomarchStatus BAD = ECHOMARCH_STATUS_BAD_INPUT;
    const EchomarchStatus GONE = ECHOMARCH_STATUS_NO_OBJECT;
    double numbers[ECHOMARCH_BANDS] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, NAN};
    uint64_t id = 0;
    REFUSED(BAD, "carpet of mine", echomarch_add_surface(sim, ROOM, 0, &id));
    EXPECT(id == ECHOMARCH_NO_ID);
    REFUSED(BAD, "", echomarch_add_surface(sim, "Surface(shape: Sphere(radius: -1))", 0, &id));
    REFUSED(BAD, "", echomarch_add_surface(sim, "Surface(shape: Egg)", 0, &id));
    REFUSED(BAD, "", echomarch_add_surface(sim, "", 0, &id));
    REFUSED(BAD, "exactly one surface, not 2", echomarch_add_surface(sim, "(shape: Plane), (shape: Plane)", 0, &id));
    REFUSED(BAD, "UTF-8", echomarch_add_surface(sim, "\xff\xfe", 0, &id));
    REFUSED(ECHOMARCH_STATUS_NULL, "text is NULL", echomarch_add_surface(sim, NULL, 0, &id));
    REFUSED(BAD, "", echomarch_add_scene(sim, "Scene("));
    REFUSED(ECHOMARCH_STATUS_NULL, "text is NULL", echomarch_add_scene(sim, NULL));
    REFUSED(BAD, "", echomarch_set_material(sim, "m", numbers, NULL));
    REFUSED(ECHOMARCH_STATUS_NULL, "name", echomarch_set_material(sim, NULL, numbers, NULL));
    REFUSED(ECHOMARCH_STATUS_NULL, "absorption", echomarch_set_material(sim, "m", NULL, numbers));
    REFUSED(BAD, "position", echomarch_add_source(sim, NULL, &NOWHERE, &id));
    EXPECT(id == ECHOMARCH_NO_ID);
    REFUSED(BAD, "", echomarch_add_source(sim, "Source(position: 1)", &HERE, &id));
    REFUSED(GONE, "removed", echomarch_place_source(sim, 77, &HERE));
    REFUSED(GONE, "removed", echomarch_place_source(sim, ECHOMARCH_NO_ID, &HERE));
    REFUSED(ECHOMARCH_STATUS_NULL, "pose", echomarch_place_source(sim, 0, NULL));
    REFUSED(GONE, "removed", echomarch_enable_source(sim, 77, 1));
    REFUSED(GONE, "removed", echomarch_set_source(sim, 77, 0, 1));
    REFUSED(GONE, "removed", echomarch_remove_source(sim, 77));
    REFUSED(GONE, "removed", echomarch_place_surface(sim, 77, &HERE));
    REFUSED(GONE, "removed", echomarch_set_surface(sim, 77, BOX));
    REFUSED(GONE, "removed", echomarch_enable_surface(sim, 77, 1));
    REFUSED(GONE, "removed", echomarch_remove_surface(sim, 77));
    REFUSED(BAD, "position", echomarch_place_listener(sim, &NOWHERE));
    REFUSED(BAD, "quaternion", echomarch_place_listener(sim, &UNTURNED));
    REFUSED(ECHOMARCH_STATUS_NULL, "pose", echomarch_place_listener(sim, NULL));
    REFUSED(BAD, "head", echomarch_turn_head(sim, UNTURNED.rotation));
    REFUSED(ECHOMARCH_STATUS_NULL, "rotation", echomarch_turn_head(sim, NULL));
    REFUSED(ECHOMARCH_STATUS_NULL, "state", echomarch_state(sim, NULL));
    REFUSED(ECHOMARCH_STATUS_NULL, "would_compile", echomarch_would_compile(sim, NULL));
}

static void test_formats(uint64_t source) {
    EchomarchMix *mix;
    EchomarchEars *ears;
    EchomarchFormat format;
    EXPECT(echomarch_default_format(48000, &format) == OK);
    REFUSED(ECHOMARCH_STATUS_NULL, "mix", echomarch_mix_new(sim, &format, NULL));
    REFUSED(ECHOMARCH_STATUS_NULL, "format", echomarch_mix_new(sim, NULL, &mix));
    REFUSED(ECHOMARCH_STATUS_NULL, "format", echomarch_ears_new(sim, source, NULL, &ears));
    REFUSED(ECHOMARCH_STATUS_NO_OBJECT, "removed", echomarch_ears_new(sim, 77, &format, &ears));
    EXPECT(mix == NULL && ears == NULL);
    format.longest_s = NAN;
    REFUSED(ECHOMARCH_STATUS_BAD_INPUT, "delay", echomarch_mix_new(sim, &format, &mix));
    EXPECT(echomarch_default_format(1, &format) == OK);
    REFUSED(ECHOMARCH_STATUS_BAD_INPUT, "rate", echomarch_mix_new(sim, &format, &mix));
    EXPECT(echomarch_default_format(48000, &format) == OK);
    format.head_file = "no-such-head.sofa";
    REFUSED(ECHOMARCH_STATUS_BAD_INPUT, "no-such-head.sofa", echomarch_mix_new(sim, &format, &mix));
}

typedef struct {
    EchomarchMix *mix;
    EchomarchEars *ears;
    uint64_t source;
    /* The loudest sample of each, and whether the callback was called for another source. */
    float loudest_mix, loudest_ears;
    int wrong_source;
    atomic_int stop;
    /* 1 if the mix was heard, 2 if the ears were. */
    atomic_int heard;
} Audio;

static void fill(void *user, uint64_t source, float *samples, size_t count) {
    Audio *audio = user;
    audio->wrong_source |= source != audio->source;
    for (size_t index = 0; index < count; index++) {
        samples[index] = index == 7 ? NAN : (float)sin(0.3 * (double)index);
    }
}

static float loudest(float most, const float *samples) {
    for (size_t index = 0; index < 2 * FRAMES; index++) {
        if (!(fabsf(samples[index]) <= most)) {
            most = fabsf(samples[index]);
        }
    }
    return most;
}

static void *play(void *user) {
    Audio *audio = user;
    float mono[FRAMES], stereo[2 * FRAMES];
    for (size_t index = 0; index < FRAMES; index++) {
        mono[index] = (float)sin(0.3 * (double)index);
    }
    while (!atomic_load(&audio->stop)) {
        EXPECT(echomarch_mix_process(audio->mix, stereo, FRAMES, fill, audio) == OK);
        audio->loudest_mix = loudest(audio->loudest_mix, stereo);
        EXPECT(echomarch_ears_process(audio->ears, mono, stereo, FRAMES) == OK);
        audio->loudest_ears = loudest(audio->loudest_ears, stereo);
        atomic_store(&audio->heard, (audio->loudest_mix > 0.05f) | (audio->loudest_ears > 0.05f) << 1);
        rest();
    }
    EXPECT(echomarch_mix_process(audio->mix, NULL, FRAMES, fill, audio) == ECHOMARCH_STATUS_NULL);
    EXPECT(echomarch_mix_process(audio->mix, NULL, 0, fill, audio) == OK);
    EXPECT(echomarch_mix_process(audio->mix, stereo, FRAMES, NULL, NULL) == OK);
    EXPECT(echomarch_ears_process(audio->ears, NULL, stereo, FRAMES) == ECHOMARCH_STATUS_NULL);
    EXPECT(echomarch_ears_process(audio->ears, mono, NULL, FRAMES) == ECHOMARCH_STATUS_NULL);
    return NULL;
}

/* Waits for an update of the commit with a trace and a ready state, LIMIT_S at most. */
static EchomarchUpdate wait_for(uint64_t source, uint64_t commit, EchomarchEcho *echoes, size_t capacity) {
    EchomarchUpdate update;
    EchomarchState state = ECHOMARCH_STATE_COMPILING;
    memset(&update, 0, sizeof update);
    time_t end = time(NULL) + LIMIT_S;
    do {
        rest();
        EchomarchStatus status = echomarch_update(sim, source, &update, echoes, capacity);
        EXPECT(status == OK || status == ECHOMARCH_STATUS_NOT_YET);
        EXPECT(echomarch_state(sim, &state) == OK && state != ECHOMARCH_STATE_FAILED);
    } while ((update.traces == 0 || update.commit < commit || state != ECHOMARCH_STATE_READY) && time(NULL) < end);
    EXPECT(update.traces > 0 && update.commit >= commit && state == ECHOMARCH_STATE_READY);
    return update;
}

static void test_world(void) {
    const double absorption[ECHOMARCH_BANDS] = {0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.4, 0.4};
    const double scattering[ECHOMARCH_BANDS] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
    uint64_t room, box, source, number;
    uint32_t answer = 7;
    EXPECT(echomarch_set_material(sim, "carpet of mine", absorption, scattering) == OK);
    EXPECT(echomarch_add_surface(sim, ROOM, 0, &room) == OK);
    EXPECT(echomarch_add_surface(sim, BOX, 1, &box) == OK && box != room);
    EXPECT(echomarch_add_source(sim, "Source(position: (0, 0, 0), level_db: -6)", &HERE, &source) == OK);
    EXPECT(echomarch_set_source(sim, source, 0, 2) == OK);
    REFUSED(ECHOMARCH_STATUS_BAD_INPUT, "level", echomarch_set_source(sim, source, NAN, 2));
    REFUSED(ECHOMARCH_STATUS_BAD_INPUT, "priority", echomarch_set_source(sim, source, 0, 0));
    REFUSED(ECHOMARCH_STATUS_BAD_INPUT, "quaternion", echomarch_place_source(sim, source, &UNTURNED));
    EXPECT(echomarch_place_listener(sim, &(EchomarchPose){{1, 0, 1}, {0, 0, 0, 1}}) == OK);
    test_formats(source);
    EchomarchFormat format;
    static Audio audio;
    audio.source = source;
    EXPECT(echomarch_default_format(48000, &format) == OK);
    EXPECT(echomarch_mix_new(sim, &format, &audio.mix) == OK);
    EXPECT(echomarch_ears_new(sim, source, &format, &audio.ears) == OK);
    EXPECT(echomarch_update(sim, source, &(EchomarchUpdate){.waves = 0}, NULL, 0) == ECHOMARCH_STATUS_NOT_YET);
    pthread_t thread;
    EXPECT(pthread_create(&thread, NULL, play, &audio) == 0);
    EXPECT(echomarch_commit(sim, &number) == OK && number == 1);
    EchomarchEcho echoes[4];
    EchomarchUpdate heard = wait_for(source, number, echoes, 4);
    /* Two metres away, ahead: half the level of 1 m, after 5.8 ms. */
    EXPECT(heard.is_in_sight == 1 && heard.visibility == 1);
    EXPECT(fabs(heard.direct_gain[4] - 0.5) < 1e-3 && fabs(heard.direct_delay_s - 2 / 343.0) < 1e-5);
    EXPECT(heard.direct_from[2] < -0.999f && heard.from[2] < -0.999f);
    EXPECT(heard.echoes > 4 && echoes[0].delay_s <= echoes[3].delay_s && echoes[0].key != echoes[3].key);
    EXPECT(echoes[0].delay_s > heard.direct_delay_s && echoes[0].gain[0] > 0);
    EXPECT(heard.decay_s[0] > 0.05 && heard.reverb_gain[0] > 0 && heard.waves > 0);
    REFUSED(ECHOMARCH_STATUS_NULL, "update", echomarch_update(sim, source, NULL, NULL, 0));

    /* The box between both hides the source. */
    EXPECT(echomarch_place_surface(sim, box, &(EchomarchPose){{1, 0, 0}, {0, 0.38f, 0, 0.92f}}) == OK);
    EXPECT(echomarch_would_compile(sim, &answer) == OK && answer == 0);
    EXPECT(echomarch_commit(sim, &number) == OK && number == 2);
    heard = wait_for(source, number, NULL, 0);
    /* The gains stay until the ways around the box are found. */
    time_t end = time(NULL) + LIMIT_S;
    while (heard.visibility >= 1 && time(NULL) < end) {
        heard = wait_for(source, number, NULL, 0);
    }
    EXPECT(heard.is_in_sight == 0 && heard.visibility < 1);
    EXPECT(echomarch_set_surface(sim, box, "Surface(shape: Box(size: (0.1, 0.1, 0.1)))") == OK);
    EXPECT(echomarch_enable_surface(sim, box, 0) == OK);
    EXPECT(echomarch_remove_surface(sim, box) == OK);
    REFUSED(ECHOMARCH_STATUS_NO_OBJECT, "removed", echomarch_remove_surface(sim, box));
    EXPECT(echomarch_enable_source(sim, source, 0) == OK && echomarch_enable_source(sim, source, 1) == OK);

    EXPECT(echomarch_turn_head(sim, (const float[]){0, 0.7071f, 0, 0.7071f}) == OK);

    /* The sound of both fades in. Then the simulator ends before them. */
    end = time(NULL) + LIMIT_S;
    while ((atomic_load(&audio.heard) & 3) != 3 && time(NULL) < end) {
        rest();
    }
    echomarch_simulator_free(sim);
    sim = NULL;
    rest();
    atomic_store(&audio.stop, 1);
    pthread_join(thread, NULL);
    EXPECT(!audio.wrong_source);
    printf("loudest samples: %g in the mix, %g in the ears\n", audio.loudest_mix, audio.loudest_ears);
    EXPECT(audio.loudest_mix > 0.05f && audio.loudest_mix < 20);
    EXPECT(audio.loudest_ears > 0.05f && audio.loudest_ears < 20);
    echomarch_mix_free(audio.mix);
    echomarch_ears_free(audio.ears);
}

/* A second simulator with a whole scene, whose mix is freed first. */
static void test_scene(void) {
    EchomarchMix *mix;
    EchomarchFormat format;
    EXPECT(echomarch_simulator_new(NULL, &sim, NULL, 0) == OK);
    EXPECT(echomarch_add_scene(sim, "Scene(surfaces: [(shape: Room(size: (5, 3, 4)), material: \"felt\")], "
                                    "materials: {\"felt\": (absorption: 0.4)}, source: (position: (1, 0, 0)), "
                                    "listener: (position: (-1, 0, 0), radius: 0.3))") == OK);
    /* The scene's materials are known to later surfaces. */
    EXPECT(echomarch_add_surface(sim, "(shape: Sphere(radius: 0.2), material: \"felt\")", 0, NULL) == OK);
    EXPECT(echomarch_default_format(44100, &format) == OK);
    EXPECT(echomarch_mix_new(sim, &format, &mix) == OK);
    EXPECT(echomarch_commit(sim, NULL) == OK);
    echomarch_mix_free(mix);
    echomarch_simulator_free(sim);
    sim = NULL;
}

int main(void) {
    test_nothing();
    test_settings();
    test_bad_inputs();
    test_world();
    test_scene();
    printf(failures == 0 ? "the C interface is as documented\n" : "%d expectations failed\n", failures);
    return failures != 0;
}
