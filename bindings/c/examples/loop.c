/* The loop of a game: a source walks around the listener, a door opens, and each picture's sound is mixed.
 *
 * cc loop.c -I../include -L../../../target/release -lechomarch_c -lm -o loop
 */
#include "echomarch.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define RATE_HZ 48000
#define FRAMES (RATE_HZ / 60)

/* The game's sound of a source: here a tone of 220 Hz. */
static void fill(void *user, uint64_t source, float *samples, size_t count) {
    double *phase = user;
    (void)source;
    for (size_t index = 0; index < count; index++) {
        samples[index] = 0.2f * (float)sin(*phase);
        *phase = fmod(*phase + 6.283185307 * 220.0 / RATE_HZ, 6.283185307);
    }
}

static EchomarchSimulator *sim;

static void check(EchomarchStatus status) {
    if (status != ECHOMARCH_STATUS_OK) {
        fprintf(stderr, "echomarch: %s\n", echomarch_simulator_error(sim));
        exit(1);
    }
}

int main(int count, char **arguments) {
    int pictures = count > 1 ? atoi(arguments[1]) : 300;
    char error[256];
    if (echomarch_simulator_new(NULL, &sim, error, sizeof error) != ECHOMARCH_STATUS_OK) {
        fprintf(stderr, "no simulator: %s\n", error);
        return 1;
    }
    printf("renderer: %s\n", echomarch_simulator_renderer(sim));

    /* The world, in metres: x to the right, y up, z towards the viewer. */
    uint64_t door, voice;
    check(echomarch_add_surface(sim, "Surface(shape: Room(size: (10, 3, 8)), material: \"plasterboard\")", 0, NULL));
    check(echomarch_add_surface(sim, "Surface(shape: Box(size: (0.1, 3, 1)), material: \"door\")", 0, &door));
    EchomarchPose at = {{2, 0, 0}, {0, 0, 0, 1}};
    check(echomarch_add_source(sim, NULL, &at, &voice));
    EchomarchPose ears = {{-3, 0, 0}, {0, 0, 0, 1}};
    check(echomarch_place_listener(sim, &ears));

    EchomarchFormat format;
    EchomarchMix *mix;
    check(echomarch_default_format(RATE_HZ, &format));
    check(echomarch_mix_new(sim, &format, &mix));

    float stereo[2 * FRAMES];
    double phase = 0;
    for (int picture = 0; picture < pictures; picture++) {
        double seconds = picture / 60.0;
        at.position[0] = (float)(3 * cos(seconds));
        at.position[2] = (float)(3 * sin(seconds));
        check(echomarch_place_source(sim, voice, &at));
        EchomarchPose open = {{-1, 0, (float)(0.5 + 0.5 * sin(seconds))}, {0, 0, 0, 1}};
        check(echomarch_place_surface(sim, door, &open));
        check(echomarch_commit(sim, NULL));

        EchomarchUpdate heard;
        if (picture % 60 == 0 && echomarch_update(sim, voice, &heard, NULL, 0) == ECHOMARCH_STATUS_OK) {
            printf("%4.1f s: gain %.3f at 1 kHz, %u echoes, decay %.2f s\n", seconds, heard.direct_gain[4],
                   heard.echoes, heard.decay_s[4]);
        }
        /* A game calls this in its audio callback, on another thread. */
        echomarch_mix_process(mix, stereo, FRAMES, fill, &phase);
        nanosleep(&(struct timespec){0, 16666667}, NULL);
    }
    echomarch_mix_free(mix);
    echomarch_simulator_free(sim);
    return 0;
}
