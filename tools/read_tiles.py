"""Reads a tileset and all its contents with py3dtiles (PyPI), a third reader.

    pip install py3dtiles
    python3 tools/read_tiles.py TILESET.json...

A line a tileset. Whatever py3dtiles refuses ends the script with its error.
"""

import sys
from pathlib import Path

from py3dtiles.tileset.tileset import TileSet


def read(path: Path) -> str:
    tileset = TileSet.from_file(path)
    tiles = contents = 0
    waiting = [tileset.root_tile]
    while waiting:
        tile = waiting.pop()
        tiles += 1
        if tile.has_content():
            tile.get_or_fetch_content(tileset.root_uri)
            contents += 1
        waiting.extend(tile.children)
    return f"{path}: {tiles} tiles, {contents} contents read"


for name in sys.argv[1:]:
    print(read(Path(name)))
