"""Files of public repositories, from clones of these."""

import fnmatch
import pathlib
import re
import subprocess


def numbers(path):
    """Sort key: the numbers in a file name."""
    return [int(digits) for digits in re.findall(r"\d+", pathlib.Path(path).name)]


def extract(clone, commit, pattern, folder):
    """Writes the files of a commit that match a pattern into a new folder. Returns their paths, sorted by number."""
    tree = f"{commit}:{pathlib.PurePath(pattern).parent}".removesuffix(":.")
    listed = subprocess.run(["git", "-C", clone, "ls-tree", "--name-only", tree], check=True, capture_output=True, text=True)
    names = fnmatch.filter(listed.stdout.splitlines(), pathlib.PurePath(pattern).name)
    folder.mkdir()
    archive = subprocess.run(["git", "-C", clone, "archive", tree, *names], check=True, capture_output=True).stdout
    subprocess.run(["tar", "--extract", "--directory", folder], input=archive, check=True)
    return sorted((folder / name for name in names), key=numbers)


def paths(clones, repository, commit, folder):
    """Paths of all files below a folder of a commit."""
    command = ["git", "-C", f"{clones}/{repository}", "ls-tree", "-rz", "--name-only", commit, f"{folder}/"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.split("\0")[:-1]


def read(clones, repository, commit, path, binary=False):
    """Text or bytes of a file of a commit."""
    command = ["git", "-C", f"{clones}/{repository}", "show", f"{commit}:{path}"]
    return subprocess.run(command, check=True, capture_output=True, text=not binary).stdout
