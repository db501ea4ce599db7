"""Processor time of pyroomacoustics' impulse response in the room of examples/response_cost.rs."""

import time

import pyroomacoustics as pra

room = pra.ShoeBox(
    [8, 3, 5],
    fs=48000,
    materials=pra.Material(0.2),
    max_order=3,
    ray_tracing=True,
    air_absorption=False,
)
room.set_ray_tracing(n_rays=100000, receiver_radius=0.3)
room.add_source([2, 1.5, 1])
room.add_microphone([6, 1.2, 4])
began = time.process_time()
room.compute_rir()
ended = time.process_time()
print(f"compute_rir {ended - began:.3f} s, the whole process {ended:.3f} s")
