# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.citing import Citation as Citation
from liepoisson.citing import Work as Work
from liepoisson.citing import cite as cite
