"""The study of *The Twisted Top* by J.-L. Thiffeault and P. J. Morrison (2001).

`study.reproduce` runs it all; `runs` says what is computed, `measurements` what is measured, `claims` what the paper
says and whether it holds, `figures` and `report` show it.
"""
