"""Kernels are compiled for many sets of requirements: the program stays small all the same."""

import struct
import unittest

import program

MOST_BYTES = 40_000_000
DEBUGGING = (".debug", ".symtab", ".strtab", ".gnu_debug", ".comment")


def bytes_without_debugging(path):
    """Of an ELF file of 64 bits, little-endian: its sections, but for those that only a debugger reads."""
    data = path.read_bytes()
    if data[:6] != b"\x7fELF\x02\x01":
        raise unittest.SkipTest(f"{path} is no 64-bit ELF file")
    (table,) = struct.unpack_from("<Q", data, 40)
    size, count, names = struct.unpack_from("<HHH", data, 58)
    sections = [struct.unpack_from("<IIQQQQ", data, table + i * size) for i in range(count)]
    name_of = lambda section: data[sections[names][4] + section[0]:].split(b"\0", 1)[0].decode()  # noqa: E731
    without_bytes = 8  # SHT_NOBITS: takes no place in the file
    return sum(section[5] for section in sections if section[1] != without_bytes and not name_of(section).startswith(DEBUGGING))


class Size(unittest.TestCase):
    def test_the_program_is_small(self):
        size = bytes_without_debugging(program.Path(program.KADR))
        self.assertGreater(size, 1_000_000, "the sections were not found")
        self.assertLess(size, MOST_BYTES, "compile fewer sets of requirements: src/device/embree/kernel_sets.h")


if __name__ == "__main__":
    program.main()
