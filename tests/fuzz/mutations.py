# SPDX-License-Identifier: BSD-3-Clause
"""Mutations of inputs: XML by its tree, Exodus files by dimensions, variables and attributes, all files by bytes, command lines."""
import copy
import struct
import xml.etree.ElementTree as ET

INTEGERS = ["0", "-1", "1", "2", "7", "2147483647", "2147483648", "-2147483648", "9223372036854775807", "1e3", "0x10", "1.5", "", " ",
            "99999999999999999999"]
NUMBERS = ["0", "-0.0", "1", "-1", "0.5", "1e-308", "1e-320", "1e308", "1e999", "nan", "-inf", "inf", "0.49999999999", "1,5", "1e", "--1", "",
           "0x1p3", "1e-7", "3"]
WORDS = ["", " ", "Automatic", "automatic", "METIS", "Bricks", "Coulomb", "Tresca", "None", "Tied", "SMALSE", "Subspace Newton", "true", "xyz",
         "x", "zzz", "upper_top", "lower_bottom", "upper", "{}", "}{", "\u00e9\u4e2d\U0001f600", "a" * 5000, "../..", "/", "/dev/null", "/dev/zero",
         "&#10;", "%s%n%d", "stack.exo", "x*y", "sin(", "1/0", "((((", "x^1e9", "if(x>0,1", "rand()", "t"]
TYPES = ["int", "double", "string", "bool", "Array(double)", "Array(string)", "Array(int)", "TwoDArray(double)", "long long", "", "Banana"]
ARRAYS = ["{}", "{1}", "{1, 2}", "{1, 2, 3}", "{1, 2, 3, 4}", "{nan, 0, 0}", "{0, 0, 0}", "{1, , 2}", "{", "}", "{{1}, {2}}", "{a, b}",
          "{upper}", "{upper, upper}", "{lower, upper, lower}", "{1e308, 1e308, 1e308}", "3x1:{1,2,3}", "{" + "1," * 5000 + "1}"]


def any_value(random):
    return random.choice(random.choice([INTEGERS, NUMBERS, WORDS, ARRAYS]))


def mutate_bytes(random, data, most=8, kinds=(0, 1, 2, 3, 4, 5, 6)):
    """Bits flipped, bytes replaced, pieces removed, doubled or moved, the end cut off; 1 to `most` times."""
    data = bytearray(data)
    for _ in range(random.randint(1, most)):
        if not data:
            break
        at, length = random.randrange(len(data)), min(random.choice([1, 2, 4, 8, 64]), len(data))
        kind = random.choice(kinds)
        if kind == 0:
            data[at] ^= 1 << random.randrange(8)
        elif kind == 1:
            data[at] = random.choice([0, 1, 0x7F, 0x80, 0xFF, random.randrange(256)])
        elif kind == 2:
            del data[at:at + length]
        elif kind == 3:
            data[at:at] = data[at:at + length]
        elif kind == 4:
            other = random.randrange(len(data))
            data[at:at + length] = data[other:other + length]
        elif kind == 5:
            data[at:at + 4] = struct.pack(">I", random.choice([0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, random.getrandbits(16)]))
        elif random.random() < 0.3:
            del data[at:]
    return bytes(data)


def mutate_xml(random, text):
    """One to four changes of names, types, values and structure, or of bytes."""
    if random.random() < 0.15:
        return mutate_bytes(random, text.encode())
    if random.random() < 0.005:  # deeper than the serializer goes
        depth = random.choice([10000, 200000])
        return text.replace("</ParameterList>", "<ParameterList name='deep'>" * depth + "</ParameterList>" * (depth + 1), 1).encode()
    root = ET.fromstring(text)
    for _ in range(random.choice([1, 1, 1, 2, 2, 3, 4])):
        _mutate_tree(random, root)
    return ET.tostring(root, encoding="utf-8")


def _mutate_tree(random, root):
    parents = {child: parent for parent in root.iter() for child in parent}
    values = [node for node in parents if node.tag == "Parameter"]
    node = random.choice(list(parents)) if parents else root
    parent, kind = parents.get(node, root), random.randrange(10)
    if kind <= 4 and values:
        _mutate_value(random, random.choice(values))
    elif kind == 5 and node is not root:
        parent.remove(node)
    elif kind == 6:
        parent.append(copy.deepcopy(node))
    elif kind == 7:
        random.choice(list(root.iter())).append(copy.deepcopy(node))
    elif kind == 8:
        node.set(random.choice(["name", "type", "value", "docString", "id"]), random.choice(WORDS + TYPES))
    elif random.random() < 0.5:
        node.tag = random.choice(["Parameter", "ParameterList", "Banana"])
    else:
        for _ in range(random.choice([1, 50, 300])):
            node = ET.SubElement(node, "ParameterList", name="deep")


def _mutate_value(random, node):
    kind = node.get("type") or ""
    pool = {"int": INTEGERS, "double": NUMBERS, "string": WORDS}.get(kind, ARRAYS)
    choice = random.randrange(4)
    if choice <= 1:
        node.set("value", random.choice(pool))
    elif choice == 2:
        node.set("value", any_value(random))
    else:
        node.set("type", random.choice(TYPES))


def mutate_exodus(random, file):
    """A copy of a classic file's plain data with one to three changes; the header may no longer fit the data."""
    file = copy.deepcopy(file)
    for _ in range(random.choice([1, 1, 2, 3])):
        random.choice([_dimension, _dimension, _data, _data, _data, _variable, _attribute, _list])(random, file)
    return file


def _dimension(random, file):
    dimension = random.choice(file.dimensions)
    if random.random() < 0.15:
        dimension[0] = random.choice(["num_nodes", "num_elem", "x", "", "num_el_in_blk1", "n" * 300])
    else:
        dimension[1] = random.choice([0, 1, 2, dimension[1] + 1, max(0, dimension[1] - 1), 10 * dimension[1], 65536, 0x7FFFFFFF, 0x80000000,
                                      0xFFFFFFFF])


NUMERIC = {4: ("i", [0, 1, -1, 2, 9, 100, 0x7FFFFFFF, -0x80000000, 65536]),
           5: ("f", [0.0, float("nan"), 1e38, 5.0, -1.0]),
           6: ("d", [0.0, float("nan"), float("inf"), 1e308, -1e308, 1e-308, 0.5, 1.0, 1e20])}


def _data(random, file):
    variable = random.choice([v for v in file.variables if v.data] or file.variables)
    code, pool = NUMERIC.get(variable.type, ("c", [b"\0", b"\xff", b"A", b"9", b" "]))
    size = struct.calcsize(">" + code)
    count = len(variable.data) // size
    if not count:
        return
    data = bytearray(variable.data)
    for _ in range(random.choice([1, 1, 3, count])):
        at = size * random.randrange(count)
        other = size * random.randrange(count)
        value = data[other:other + size] if random.random() < 0.4 else struct.pack(">" + code, random.choice(pool))
        data[at:at + size] = value
    variable.data = bytes(data)


def _variable(random, file):
    variable = random.choice(file.variables)
    kind = random.randrange(7)
    if kind == 0:
        file.variables.remove(variable)
    elif kind == 1:
        variable.name = random.choice([v.name for v in file.variables] + ["", "x" * 400, "coordx", "connect1", "connect9"])
    elif kind == 2:
        variable.type = random.choice([0, 1, 2, 3, 4, 5, 6, 7, 12, 255])
    elif kind == 3:
        variable.dimensions = [random.randrange(len(file.dimensions) + 1) for _ in range(random.choice([0, 1, 2, 3, 40]))]
    elif kind == 4:
        variable.begin_shift = random.choice([-8, 8, 1 << 31, 1 << 62, -(1 << 20), 4])
    elif kind == 5:
        variable.data = mutate_bytes(random, variable.data)
    else:
        file.variables.append(copy.deepcopy(variable))
    if not file.variables:
        file.variables.append(variable)


def _attribute(random, file):
    owners = [file] + [v for v in file.variables if v.attributes]
    attributes = random.choice(owners).attributes
    if not attributes:
        return
    attribute = random.choice(attributes)
    kind = random.randrange(4)
    if kind == 0:
        attributes.remove(attribute)
    elif kind == 1:
        attribute[2] = random.choice([b"", b"HEX8", b"HEX", b"TETRA10", b"SPHERE", b"HEX20", b"\xff\xfe", b"A" * 100, b"TETRA4", b"\0\0\0\7"])
    elif kind == 2:
        attribute[1] = random.choice([1, 2, 3, 4, 5, 6, 0, 99])
    else:
        attribute[0] = random.choice(["elem_type", "version", "api_version", "title", "floating_point_word_size", "int64_status",
                                      "maximum_name_length", "_FillValue", "name", ""])


def _list(random, file):
    if random.random() < 0.5:
        file.records = random.choice([1, 5, 0x7FFFFFFF, 0xFFFFFFFF])
    else:
        random.shuffle(file.dimensions if random.random() < 0.5 else file.variables)


OPTIONS = ["--set", "--output", "--summary", "--validate-only", "--print-parameters", "--version", "--help", "--", "-n", "--set=", "--sett"]


def command_line(random, input_name):
    """Arguments with known and unknown options, doubled, without their values, with strange ones."""
    paths = ["Solver->Relative Tolerance", "Solver->Method", "Mesh->File", "Contact->joint->Friction->Coefficients", "Decomposition->Subdomains",
             "Boundary Conditions->press->Value", "Output", "Output->File", "->", "", "Solver->", "A->B->C", "Materials->soft->Young's Modulus"]
    arguments = [input_name]
    for _ in range(random.randint(1, 4)):
        kind = random.randrange(4)
        if kind <= 1:
            arguments += ["--set", random.choice(paths) + random.choice(["=", "=", "=", "", "=="]) + any_value(random)]
        elif kind == 2:
            arguments.insert(random.randrange(len(arguments) + 1), random.choice(OPTIONS))
        else:
            arguments.append(any_value(random))
    if random.random() < 0.1:
        arguments.remove(input_name)
    return [a.replace("\0", "") for a in arguments]
