# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.compile.field import PiecesField as PiecesField
from liepoisson.compile.field import QuadraticField as QuadraticField
from liepoisson.compile.field import TapeField as TapeField
from liepoisson.compile.field import TopField as TopField
