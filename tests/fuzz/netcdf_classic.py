# SPDX-License-Identifier: BSD-3-Clause
"""netCDF classic files as plain data, written without a check: a header may say what is not so.

Source: "The NetCDF Classic Format Specification" (Unidata); variant CDF-2, 64-bit offsets.
"""
import dataclasses
import struct

import netCDF4
import numpy as np

TYPES = {"S1": 2, "i4": 4, "f4": 5, "f8": 6}
SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 4, 6: 8}


@dataclasses.dataclass
class Variable:
    name: str
    dimensions: list  # indices into File.dimensions
    attributes: list  # [name, type, bytes]
    type: int
    data: bytes  # big endian
    begin_shift: int = 0  # what the header adds to the true offset


@dataclasses.dataclass
class File:
    dimensions: list  # [name, length]; the record dimension has length 0
    attributes: list
    variables: list
    records: int = 0


def read(path):
    """A netCDF file without records of data, as plain data."""
    with netCDF4.Dataset(path) as source:
        source.set_auto_mask(False)
        names = list(source.dimensions)
        dimensions = [[n, 0 if d.isunlimited() else len(d)] for n, d in source.dimensions.items()]
        variables = [Variable(n, [names.index(d) for d in v.dimensions], [_attribute(v, a) for a in v.ncattrs()],
                              TYPES[v.dtype.str[1:]], np.asarray(v[:]).astype(v.dtype.newbyteorder(">")).tobytes())
                     for n, v in source.variables.items()]
        return File(dimensions, [_attribute(source, a) for a in source.ncattrs()], variables)


def _attribute(owner, name):
    value = owner.getncattr(name)
    if isinstance(value, str):
        return [name, 2, value.encode()]
    array = np.atleast_1d(value)
    return [name, TYPES[array.dtype.str[1:]], array.astype(array.dtype.newbyteorder(">")).tobytes()]


def _padded(data):
    return data + b"\0" * (-len(data) % 4)


def _int(value):
    return struct.pack(">I", int(value) & 0xFFFFFFFF)


def _name(text):
    return _int(len(text.encode())) + _padded(text.encode())


def _list(tag, items):
    return _int(tag if items else 0) + _int(len(items)) + b"".join(items)


def _attributes(items):
    return _list(12, [_name(n) + _int(t) + _int(len(data) // SIZES.get(t, 1)) + _padded(data) for n, t, data in items])


def _variable(v, begin):
    return (_name(v.name) + _int(len(v.dimensions)) + b"".join(map(_int, v.dimensions)) + _attributes(v.attributes) + _int(v.type)
            + _int(len(_padded(v.data))) + struct.pack(">Q", (begin + v.begin_shift) & 0xFFFFFFFFFFFFFFFF))


def to_bytes(file):
    head = (b"CDF\x02" + _int(file.records) + _list(10, [_name(n) + _int(length) for n, length in file.dimensions])
            + _attributes(file.attributes))

    def header(begins):
        return head + _list(11, [_variable(v, b) for v, b in zip(file.variables, begins)])

    begin, begins = len(header([0] * len(file.variables))), {}
    stored = sorted(file.variables, key=lambda v: not v.data)  # records, which have no data here, begin after all else
    for variable in stored:
        begins[id(variable)] = begin
        begin += len(_padded(variable.data))
    return header([begins[id(v)] for v in file.variables]) + b"".join(_padded(v.data) for v in stored)
