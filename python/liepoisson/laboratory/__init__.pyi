# Each name of this chapter, once: what type checkers read and, at run time, what is loaded on first use.
from liepoisson.laboratory.pages import Page as Page
from liepoisson.laboratory.pages import page_of as page_of
from liepoisson.laboratory.pages import page_of_tops as page_of_tops
from liepoisson.laboratory.pages import write_page as write_page
from liepoisson.laboratory.server import PageServer as PageServer
from liepoisson.laboratory.server import serve as serve
from liepoisson.laboratory.views import view as view
