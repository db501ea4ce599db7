"""Writes the SOFA files of this folder with the HDF5 library: h5py 3.16 with HDF5 2.0, `python make.py`."""

import h5py
import numpy as np

POSITIONS = [[0, 0, 1.5], [90, 0, 1.5], [0, 90, 1.5]]
# The response of measurement m and ear e is a click of height 0.25 (m + 1) at sample m + e.
RESPONSES = np.zeros((3, 2, 8), np.float32)
for m in range(3):
    for e in range(2):
        RESPONSES[m, e, m + e] = 0.25 * (m + 1)

PIECES = {"chunks": (2, 1, 5)}
SUMS = {**PIECES, "compression": "gzip", "shuffle": True, "fletcher32": True}


def write(name, libver, how, endless=0):
    with h5py.File(name, "w", libver=libver) as file:
        for key, value in {
            "Conventions": "SOFA",
            "Version": "2.1",
            "SOFAConventions": "SimpleFreeFieldHRIR",
            "SOFAConventionsVersion": "1.0",
            "DataType": "FIR",
        }.items():
            file.attrs[key] = np.bytes_(value)
        most = (None,) * endless + (3, 2, 8)[endless:]
        file.create_dataset("Data.IR", data=RESPONSES, maxshape=most if endless else None, **how)
        rate = file.create_dataset("Data.SamplingRate", data=[48000.0])
        rate.attrs["Units"] = np.bytes_("hertz")
        positions = file.create_dataset("SourcePosition", data=np.array(POSITIONS, float))
        positions.attrs["Type"] = np.bytes_("spherical")
        positions.attrs["Units"] = np.bytes_("degree, degree, metre")


write("earliest-gzip.sofa", ("earliest", "v108"), SUMS)
write("v110-chunked.sofa", ("v110", "v110"), PIECES)
write("v112-gzip.sofa", ("v112", "v112"), SUMS)
write("v112-endless.sofa", ("v112", "v112"), SUMS, 1)
write("latest-whole.sofa", ("latest", "latest"), {})
write("latest-chunked.sofa", ("latest", "latest"), PIECES)
# Files that are not supported: the data layout of HDF5 2.0, and chunks in a version 2 B-tree.
write("latest-gzip.sofa", ("latest", "latest"), SUMS)
write("v112-endless-twice.sofa", ("v112", "v112"), SUMS, 2)
