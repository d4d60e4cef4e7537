# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.saved.citation import Citation as Citation
from liepoisson.saved.citation import Work as Work
from liepoisson.saved.citation import cite as cite
