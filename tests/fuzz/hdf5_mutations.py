# SPDX-License-Identifier: BSD-3-Clause
"""HDF5 files whose structure is changed: by what netCDF calls dimensions and variables, and by objects, links, types of HDF5 itself."""
import io
import pathlib
import tempfile

import h5py
import netCDF4
import numpy as np

import mutations

TYPES = {2: "S1", 4: "i4", 5: "f4", 6: "f8"}
OTHER_TYPES = ["i1", "u2", "i8", "u8", "f4", "S1", str]
LARGE = 1 << 16  # values; what is larger is stated, not written
ROUND = 0.1  # groups that are members of themselves cost seconds


def mutate_plain(random, file):
    """The changes of a classic file, and counts that only HDF5 can state without the data, in a file that the netCDF library writes."""
    file = mutations.mutate_exodus(random, file)
    if random.random() < 0.15:
        random.choice(file.dimensions)[1] = random.choice([1 << 20, 1 << 22, 1 << 24, 1 << 33, 1 << 40])
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "m.exo"
        with netCDF4.Dataset(path, "w", format="NETCDF4") as out:
            _write_plain(random, file, out)
        return path.read_bytes()


def _write_plain(random, file, out):
    """Leaves out what the library refuses to write."""
    for name, length in file.dimensions:
        _attempt(lambda name=name, length=length: out.createDimension(name, length or None))
    _write_attributes(out, file.attributes)
    for v in file.variables:
        _attempt(lambda v=v: _write_variable(random, file, v, out))


def _attempt(action):
    try:
        action()
    except (RuntimeError, ValueError, KeyError, TypeError, OverflowError, IndexError, AttributeError, OSError, MemoryError):
        pass


def _write_attributes(owner, attributes):
    for name, kind, data in attributes:
        if kind == 2:
            value = data.decode(errors="replace")
        else:
            value = np.frombuffer(data[:len(data) // 8 * 8] if kind == 6 else data[:len(data) // 4 * 4], ">" + TYPES.get(kind, "i4"))
        _attempt(lambda name=name, value=value: owner.setncattr(name, value))


def _write_variable(random, file, v, out):
    names = [file.dimensions[d][0] for d in v.dimensions if d < len(file.dimensions)]
    dtype = TYPES.get(v.type) or random.choice(OTHER_TYPES)
    big = dtype in ("i4", "f8") and random.random() < 0.1
    variable = out.createVariable(v.name, ">" + dtype if big else dtype, names, zlib=random.random() < 0.2, endian="big" if big else "native")
    _write_attributes(variable, v.attributes)
    values = np.frombuffer(v.data[:len(v.data) // 8 * 8] if v.type == 6 else v.data, ">" + TYPES.get(v.type, "S1"))
    shape = [len(out.dimensions[n]) or 1 for n in names]
    if dtype is not str and values.size and np.prod(shape, dtype=float) < LARGE:
        variable[...] = np.resize(values.astype(dtype), shape)


def mutate_objects(random, data):
    """One to three changes of the objects of a file; what the library refuses is left out."""
    room = io.BytesIO(data)
    with h5py.File(room, "r+") as file:
        for _ in range(random.choice([1, 1, 2, 3])):
            names = sorted(file)
            if names:
                change = random.choice([_type, _shape, _shape, _large, _remove, _link, _group, _attribute, _attribute, _values, _empty, _storage])
                _attempt(lambda change=change, name=random.choice(names): change(random, file, name))
    return room.getvalue()


def _replace(file, name, **wanted):
    """Another dataset of that name, with the attributes of the old one, and so its dimensions, however many it has itself."""
    old = file[name]
    new = file.create_dataset("in its place", **wanted)
    for attribute in list(old.attrs):
        _attempt(lambda a=attribute: new.attrs.create(a, old.attrs[a], dtype=old.attrs.get_id(a).dtype))
    del file[name]
    file.move("in its place", name)


def _read(dataset):
    if dataset.size is None or dataset.size > LARGE:
        raise ValueError("too large")
    return dataset[...]


def _type(random, file, name):
    dtype = random.choice(["i1", "u8", ">i8", "f4", ">f8", "f2", "S1", "S40", "V8", "c16", "?", h5py.string_dtype(), h5py.vlen_dtype("i4"),
                           h5py.ref_dtype, h5py.enum_dtype({"a": 1, "b": 7}), np.dtype([("x", "f8"), ("y", "i4")])])
    shape, values = file[name].shape, _read(file[name])
    _replace(file, name, shape=shape, dtype=dtype, **({"data": values} if np.dtype(dtype).kind in "iuf" and values.dtype.kind in "iuf" else {}))


def _shape(random, file, name):
    old = file[name]
    shape = list(old.shape)
    kind = random.randrange(4)
    if kind == 0 and shape:
        shape[random.randrange(len(shape))] = random.choice([0, 1, 2, 7, 1000])
    elif kind == 1 and shape:
        shape.pop()
    elif kind == 2:
        shape.insert(0, random.choice([0, 1, 2, 5]))
    elif shape:
        at = random.randrange(len(shape))
        shape[at] = max(0, shape[at] + random.choice([-1, 1]))
    _replace(file, name, data=np.resize(_read(old), shape))


def _large(random, file, name):
    shape = list(file[name].shape) or [1]
    shape[random.randrange(len(shape))] = random.choice([1 << 16, 1 << 20, 1 << 22, 1 << 24, 1 << 31, 1 << 33, 1 << 40, (1 << 63) - 1])
    chunks = {"chunks": tuple(min(n, 64) or 1 for n in shape)} if random.random() < 0.5 else {}
    _replace(file, name, shape=shape, dtype=file[name].dtype, **chunks)


def _remove(random, file, name):
    del file[name]


def _link(random, file, name):
    other = random.choice(sorted(file))
    kind = random.randrange(5)
    if kind == 0:
        file.move(name, random.choice([other + "9", "x" * 300, "coordx", "connect1", "connect9", "num_nodes", "\N{EURO SIGN}"]))
        return
    target = [h5py.SoftLink("/" + name), h5py.SoftLink("/nowhere"), h5py.ExternalLink("stack.exo", "/" + name),
              file if random.random() < ROUND else file[other]][kind - 1]
    del file[name]
    file[name] = target


def _group(random, file, name):
    where = random.choice([name, "group"])
    if where == name:
        del file[name]
    group = file.create_group(where)
    if random.random() < ROUND:
        group["self"] = file
    else:
        group.create_dataset(random.choice(["coordx", "elem_ss1"]), data=np.arange(3.0))


def _attribute(random, file, name):
    owner = random.choice([file, file[name], file[name]])
    names = sorted(owner.attrs)
    if not names:
        return
    which, kind = random.choice(names), random.randrange(5)
    if kind == 0:
        del owner.attrs[which]
    elif kind == 1:
        owner.attrs[which] = random.choice([0, -1, 1 << 40, 7.5, float("nan"), "HEX8", "A" * 500, "", b"\xff\xfe"])
    elif kind == 2:
        owner.attrs[which] = random.choice([np.zeros(2, "i4"), np.ones((3, 3), "f4"), np.zeros(0, "i8"), np.arange(1000), ["HEX8", "TETRA4"]])
    elif kind == 3:
        owner.attrs[which] = h5py.Empty(random.choice(["f4", "i8", "S10"]))
    else:
        owner.attrs[which] = file[random.choice(sorted(file))].ref


def _values(random, file, name):
    values = _read(file[name])
    if values.dtype.kind not in "iuf" or not values.size:
        return
    pool = [0, 1, -1, 9, 100, (1 << 31) - 1] if values.dtype.kind in "iu" else [0.0, float("nan"), float("inf"), 1e308, 1e-308, 0.5]
    for _ in range(random.choice([1, 3])):
        with np.errstate(all="ignore"):
            values.flat[random.randrange(values.size)] = random.choice(pool)
    file[name][...] = values


def _empty(random, file, name):
    if random.random() < 0.5:
        _replace(file, name, data=h5py.Empty(file[name].dtype))
    else:
        _replace(file, name, data=_read(file[name]).flat[0])


def _storage(random, file, name):
    old = file[name]
    wanted = random.choice([{"compression": "gzip"}, {"shuffle": True}, {"fletcher32": True}, {"scaleoffset": 2}, {"compression": "lzf"},
                            {"external": [("/etc/hostname", 0, 1 << 20)]}, {"maxshape": tuple(None for _ in old.shape)}, "virtual"])
    if wanted == "virtual":
        layout = h5py.VirtualLayout(shape=old.shape, dtype=old.dtype)
        layout[...] = h5py.VirtualSource("stack.exo", random.choice([name, "nowhere"]), shape=old.shape)
        del file[name]
        file.create_virtual_dataset(name, layout)
    elif "external" in wanted:
        _replace(file, name, shape=old.shape, dtype=old.dtype, **wanted)
    else:
        _replace(file, name, data=_read(old), **wanted)
