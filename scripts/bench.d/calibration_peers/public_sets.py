"""Folders of photographs for real_sets.py, from clones of the repositories in public_sets.toml: `git clone
https://github.com/OWNER/NAME CLONES/OWNER/NAME`. A set whose clone is missing is left out."""

import glob
import json
import pathlib
import shutil
import sys
import tomllib

from clones import extract

SETS = pathlib.Path(__file__).with_name("public_sets.toml")


def copy(pattern, folder):
    folder.mkdir()
    for image in glob.glob(pattern):
        shutil.copy(image, folder)


def write_sets(clones, folder):
    """Writes the folder of each set, last `set.json`; complete ones are kept."""
    for name, entry in tomllib.loads(SETS.read_text()).items():
        repository, target = entry.get("repository"), pathlib.Path(folder) / name
        clone = pathlib.Path(clones) / (repository or "")
        if (target / "set.json").exists():
            continue
        if not clone.is_dir():
            print(f"{name} is left out: no clone {clone}", file=sys.stderr)
            continue
        shutil.rmtree(target, ignore_errors=True)
        target.parent.mkdir(parents=True, exist_ok=True)
        if repository:
            extract(clone, entry["commit"], entry["images"], target)
        else:
            copy(entry["images"], target)
        board = {key: entry[key] for key in entry.keys() - {"repository", "commit", "images"}}
        (target / "set.json").write_text(json.dumps(board))
