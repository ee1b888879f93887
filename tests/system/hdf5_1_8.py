"""Whether HDF5 1.8 can read a file, from its bytes. There is no 1.8 in Debian any more to try it with; but what its format
allows is written down (HDF5 File Format Specification 2.0, of 1.8), and what 1.10 added too (3.0). Looks at the
superblock, the header of each object and every message in it, the indexes of chunks, links and attributes.
"""

import struct

import h5py

UNDEFINED = 0xFFFFFFFFFFFFFFFF

# Message type → its largest version in 1.8; None: it has none. File space info (0x17) and all behind it are of 1.10.
LATEST = {0x00: None, 0x01: 2, 0x02: 0, 0x03: 3, 0x04: None, 0x05: 3, 0x06: 1, 0x07: 1, 0x08: 3, 0x0A: 0, 0x0B: 2, 0x0C: 3,
          0x0D: None, 0x0E: None, 0x0F: 0, 0x10: None, 0x11: None, 0x12: 1, 0x13: 0, 0x14: 0, 0x15: 0, 0x16: 0}
DATATYPE, LINK_INFO, LAYOUT, PIPELINE, CONTINUATION, ATTRIBUTE_INFO = 0x03, 0x02, 0x08, 0x0B, 0x10, 0x15
SHARED = 2          # Of a message's flags: its content stands elsewhere.
CHUNKED = 2         # Class of a layout.
LAST_FILTER = 6     # deflate, shuffle, fletcher32, szip, nbit, scaleoffset.
LAST_TREE = 9       # Of B-trees of version 2; 10 and 11 index chunks, since 1.10.


class NotForOldReaders(Exception):
    pass


def require(condition, what):
    if not condition:
        raise NotForOldReaders(what)


class File:
    def __init__(self, content):
        self.content = content
        self.messages = 0
        self.trees = 0

    def at(self, address, size):
        require(address + size <= len(self.content), f"{address}: behind the end of the file")
        return self.content[address:address + size]

    def blocks(self, address):
        """(type, flags, content) of the messages of an object, in both versions of its header."""
        if self.at(address, 4) == b"OHDR":
            version, flags = self.at(address + 4, 2)
            require(version == 2, f"{address}: object header of version {version}")
            begin = address + 6 + (16 if flags & 0x20 else 0) + (4 if flags & 0x10 else 0)
            width = 1 << (flags & 3)
            size = int.from_bytes(self.at(begin, width), "little")
            waiting = [(begin + width, size)]
            head = 6 if flags & 4 else 4
        else:
            version = self.at(address, 1)[0]
            require(version == 1, f"{address}: object header of version {version}")
            waiting = [(address + 16, struct.unpack("<I", self.at(address + 8, 4))[0])]
            head = 8
        while waiting:
            begin, size = waiting.pop()
            end = begin + size
            while begin + head <= end:
                if version == 2:
                    kind, length, how = struct.unpack("<BHB", self.at(begin, 4))
                else:
                    kind, length, how = struct.unpack("<HHB", self.at(begin, 5))
                body = self.at(begin + head, length)
                begin += head + length
                if kind == CONTINUATION:
                    where, extent = struct.unpack("<QQ", body[:16])
                    if version == 2:  # Between its signature and its checksum.
                        require(self.at(where, 4) == b"OCHK", f"{where}: no continuation")
                        where, extent = where + 4, extent - 8
                    waiting.append((where, extent))
                yield kind, how, body

    def check_tree(self, address):
        if address == UNDEFINED:
            return
        self.trees += 1
        signature, version, kind = struct.unpack("<4sBB", self.at(address, 6))
        require(signature == b"BTHD" and version == 0 and kind <= LAST_TREE, f"{address}: {signature} {version} of kind {kind}")

    def check_dense(self, kind, body):
        """Links or attributes of which there are many: a heap and its indexes."""
        flags = body[1]
        begin = 2 + ((8 if kind == LINK_INFO else 2) if flags & 1 else 0)
        heap, *trees = struct.unpack_from("<QQQ" if flags & 2 else "<QQ", body, begin)
        if heap != UNDEFINED:
            require(self.at(heap, 5) == b"FRHP\0", f"{heap}: heap {self.at(heap, 5)}")
            for tree in trees:
                self.check_tree(tree)

    def check_object(self, address, name):
        for kind, how, body in self.blocks(address):
            self.messages += 1
            require(kind in LATEST, f"{name}: message of type {kind:#x}")
            if how & SHARED or LATEST[kind] is None:
                continue
            version = body[0] >> 4 if kind == DATATYPE else body[0]
            require(version <= LATEST[kind], f"{name}: message of type {kind:#x} and version {version}")
            if kind in (LINK_INFO, ATTRIBUTE_INFO):
                self.check_dense(kind, body)
            elif kind == LAYOUT and body[1] == CHUNKED:
                address = struct.unpack_from("<Q", body, 3)[0]
                require(address == UNDEFINED or self.at(address, 4) == b"TREE", f"{name}: chunks have another index")
                self.trees += 1
            elif kind == PIPELINE:
                self.check_filters(name, body)

    @staticmethod
    def check_filters(name, body):
        version, count = body[:2]
        begin = 8 if version == 1 else 2
        for _ in range(count):
            identifier = struct.unpack_from("<H", body, begin)[0]
            require(identifier <= LAST_FILTER, f"{name}: filter {identifier}")
            # Those of the library have no name in version 2.
            length = struct.unpack_from("<H", body, begin + 2)[0] if version == 1 else 0
            values = struct.unpack_from("<H", body, begin + (6 if version == 1 else 4))[0]
            begin += (8 if version == 1 else 6) + (length + 7) // 8 * 8 + 4 * (values + (values % 2 if version == 1 else 0))


def check(path):
    """Raises NotForOldReaders. Returns how many objects, messages and indexes were looked at."""
    with open(path, "rb") as raw:
        file = File(raw.read())
    require(file.content[:8] == b"\x89HDF\r\n\x1a\n", "no HDF5 at the beginning")
    require(file.content[8] in (0, 2), f"superblock of version {file.content[8]}")
    objects = {}
    with h5py.File(path, "r") as record:
        objects[h5py.h5o.get_info(record.id).addr] = "/"
        record.visititems(lambda name, item: objects.setdefault(h5py.h5o.get_info(item.id).addr, name) and None)
    for address, name in objects.items():
        file.check_object(address, name)
    return len(objects), file.messages, file.trees
