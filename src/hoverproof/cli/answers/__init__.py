"""What each command answers: a module a result, in words for people and as JSON for machines.

An answer is given what a command found and the paths that it wrote. It says so; it computes nothing
and writes no file.
"""
