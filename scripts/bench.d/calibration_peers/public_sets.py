"""Folders of photographs for real_sets.py, from clones of the repositories in public_sets.toml: `git clone
https://github.com/OWNER/NAME CLONES/OWNER/NAME`. A set whose clone is missing is left out."""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tomllib

SETS = pathlib.Path(__file__).with_name("public_sets.toml")


def listed(clone, entry):
    """Names of the images in the repository."""
    tree = f"{entry['commit']}:{entry['folder']}"
    names = subprocess.run(["git", "-C", clone, "ls-tree", "-z", "--name-only", tree], check=True, capture_output=True, text=True).stdout
    return [name for name in names.split("\0") if re.fullmatch(entry["images"], name)]


def extract(clone, entry, folder):
    tree = f"{entry['commit']}:{entry['folder']}"
    archive = subprocess.run(["git", "-C", clone, "archive", tree, *listed(clone, entry)], check=True, capture_output=True).stdout
    subprocess.run(["tar", "--extract", "--directory", folder], input=archive, check=True)


def copy(entry, folder):
    for image in sorted(pathlib.Path(entry["folder"]).iterdir()):
        if re.fullmatch(entry["images"], image.name):
            shutil.copy(image, folder)


def write_sets(clones, folder):
    """Writes the folder of each set, with `set.json`, unless it exists."""
    for name, entry in tomllib.loads(SETS.read_text()).items():
        repository, target = entry.get("repository"), pathlib.Path(folder) / name
        clone = pathlib.Path(clones) / (repository or "")
        if target.exists():
            continue
        if not clone.is_dir():
            print(f"{name} is left out: no clone {clone}", file=sys.stderr)
            continue
        target.mkdir(parents=True)
        extract(clone, entry, target) if repository else copy(entry, target)
        board = {key: entry[key] for key in entry.keys() - {"repository", "commit", "folder", "images"}}
        (target / "set.json").write_text(json.dumps(board))
