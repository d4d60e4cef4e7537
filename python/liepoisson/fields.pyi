# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.field import PiecesField as PiecesField
from liepoisson.field import QuadraticField as QuadraticField
from liepoisson.field import TapeField as TapeField
from liepoisson.field import TopField as TopField
