/** This page as it came, before anything was changed in it. */

export const PRISTINE = document.documentElement.outerHTML;
