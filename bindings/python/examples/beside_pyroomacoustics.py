"""The first tutorial of pyroomacoustics, side by side: a room of a wanted reverberation time with two microphones.

    python beside_pyroomacoustics.py

pyroomacoustics is optional; without it only Echomarch runs.
"""

import numpy as np

import echomarch as em

RATE_HZ = 16_000
# Depth, width and height, with the origin in a corner, as in pyroomacoustics: x and y on the floor, z up.
SIZE_M = np.array([10.0, 7.5, 3.5])
SOURCE = np.array([2.5, 3.73, 1.76])
MICROPHONES = np.array([[6.3, 4.87, 1.2], [6.3, 4.93, 1.2]])
WANTED_S = 0.5


def absorption_of(reverberation_s):
    """The absorption of all walls by Sabine's formula."""
    area = 2 * (SIZE_M[0] * SIZE_M[1] + SIZE_M[1] * SIZE_M[2] + SIZE_M[2] * SIZE_M[0])
    return 24 * np.log(10) / 343 * SIZE_M.prod() / (area * reverberation_s)


def with_echomarch(absorption):
    """Impulse responses, shape (microphones, samples), and their T30 in seconds."""
    # The axes of pyfar have z up, as pyroomacoustics has; a shoebox of Echomarch is centred on the origin.
    room = em.Scene.shoebox(SIZE_M, absorption, axes="pyfar")
    room.add_source("source", SOURCE - SIZE_M / 2)
    for index, place in enumerate(MICROPHONES):
        room.add_listener(f"microphone {index}", place - SIZE_M / 2)
    found = em.responses(room.pairs(), seed=1)
    return [r.ir(RATE_HZ)[0] for r in found], [r.figures["t30"][4] for r in found]


def with_pyroomacoustics(absorption):
    """The same with pyroomacoustics; None if it is not installed."""
    try:
        import pyroomacoustics as pra
    except ImportError:
        return None
    pra.random.seed(1)
    material = pra.Material(absorption)
    room = pra.ShoeBox(SIZE_M, fs=RATE_HZ, materials=material, max_order=3, ray_tracing=True)
    room.add_source(SOURCE)
    room.add_microphone_array(MICROPHONES.T)
    room.compute_rir()
    rirs = [of_microphone[0] for of_microphone in room.rir]
    return rirs, [pra.experimental.measure_rt60(rir, fs=RATE_HZ, decay_db=30) for rir in rirs]


def main():
    absorption = absorption_of(WANTED_S)
    print(f"absorption {absorption:.3f} for {WANTED_S} s by Sabine")
    ours, theirs = with_echomarch(absorption), with_pyroomacoustics(absorption)
    for index, place in enumerate(MICROPHONES):
        direct_s = np.linalg.norm(place - SOURCE) / 343
        print(f"microphone {index}: direct sound after {1e3 * direct_s:.2f} ms")
        for name, found in (("echomarch", ours), ("pyroomacoustics", theirs)):
            if found is None:
                print(f"  {name} is not installed")
                continue
            samples = np.asarray(found[0][index])
            # pyroomacoustics delays its responses by half of the length of its fractional delay filters.
            peak_s = np.argmax(np.abs(samples)) / RATE_HZ
            print(f"  {name:16} T30 {found[1][index]:.3f} s, peak after {1e3 * peak_s:.2f} ms")


if __name__ == "__main__":
    main()
