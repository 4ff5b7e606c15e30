#!/usr/bin/env python3
"""The manual page and the bash completion of cleave, from what its --help says: `pages.py PROGRAM FOLDER`."""
import re
import subprocess
import sys
from pathlib import Path

program, folder = sys.argv[1], Path(sys.argv[2])


def ask(*arguments):
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


def sections(text):
    """Headings with the lines below them."""
    found, name = {}, ""
    for line in text.splitlines():
        heading = re.fullmatch(r"([A-Z][A-Za-z ]*):", line.strip())
        if heading and not line.startswith("  "):
            name = heading.group(1)
        else:
            found.setdefault(name, []).append(line)
    return found


def commands(text):
    for name, lines in sections(text).items():
        if name.lower() in ("subcommands", "commands"):
            return [line.split()[0] for line in lines if re.match(r"  \S", line)]
    return []


def options(text):
    return sorted(set(re.findall(r"(?<![\w-])(--?[a-zA-Z][\w-]*)", "\n".join(sections(text).get("Options", [])))))


def escape(line):
    line = line.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + line if line.startswith((".", "'")) else line


def block(text):
    return ".nf\n" + "\n".join(escape(line) for line in text.rstrip().splitlines()) + "\n.fi\n"


main = ask("--help")
version = ask("--version").split()[-1]
names = commands(main)
helps = {name: ask(name, "--help") for name in names}

page = [f'.TH CLEAVE 1 "" "cleave {version}" "User Commands"', ".SH NAME",
        "cleave \\- cut fractured rock into blocks, exactly, and say which of them will move", ".SH SYNOPSIS",
        ".B cleave", ".I COMMAND", "[\\fIOPTION\\fR...] \\fIFILE\\fR...", ".SH DESCRIPTION", block(main).rstrip(), ".SH COMMANDS"]
for name in names:
    page += [f".SS cleave {name}", block(helps[name]).rstrip()]
page += [".SH EXIT STATUS", ".TP", "0", "done", ".TP", "2", "the input is wrong; every problem is named with file, line, key and remedy",
         ".TP", "3", "the machine failed: no space, no memory, no permission", ".TP", "4",
         "a result that is not to be trusted as it is: a certificate that did not pass, a run that did not converge",
         ".SH FILES", ".I /usr/share/cleave/scene.schema.json", "says what a scene file may hold."]

lines = ["# bash completion of cleave", "_cleave() {", '  local word=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[1]}',
         "  if ((COMP_CWORD == 1)); then", f'    COMPREPLY=($(compgen -W "{" ".join(names)} {" ".join(options(main))}" -- "$word"))',
         "    return", "  fi", "  local options=", "  case $command in"]
lines += [f'    {name}) options="{" ".join(options(helps[name]))}" ;;' for name in names]
lines += ["  esac", '  [[ $word == -* ]] && COMPREPLY=($(compgen -W "$options" -- "$word"))', "}",
          "complete -o default -F _cleave cleave"]
folder.mkdir(parents=True, exist_ok=True)
(folder / "cleave.1").write_text("\n".join(page) + "\n")
(folder / "cleave").write_text("\n".join(lines) + "\n")
