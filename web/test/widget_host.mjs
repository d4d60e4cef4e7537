// A page of a browser that stands for a notebook: the script of the widget is loaded in it as anywidget loads it, and a plain
// object stands for the model.

import { chromium } from "playwright-core";

const HOST = "http://notebook.test/";

/** In the notebook: the script, and a model that keeps what it is told. */
async function mount(values) {
  const listeners = new Map();
  const heard = (name) => listeners.get(name) ?? listeners.set(name, new Set()).get(name);
  const model = {
    saved: [],
    get: (name) => values[name],
    set(name, value) {
      if (values[name] === value) return;
      values[name] = value;
      heard(`change:${name}`).forEach((does) => does());
    },
    save_changes: () => model.saved.push({ address: values.address, playing: values.playing, message: values.message }),
    on: (name, does) => heard(name).add(does),
    off: (name, does) => heard(name).delete(does),
  };
  const address = URL.createObjectURL(new Blob([values._esm], { type: "text/javascript" }));
  const { default: widget } = await import(address);
  const end = widget.render({ model, el: document.getElementById("cell") });
  Object.assign(window, { model, end, listeners });
}

/** The widget with these traits in a cell, and what is done with its model; `found.asked` and `found.wrong` are to stay empty. */
export async function hosted(traits) {
  const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
  const args = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox", "--disable-dev-shm-usage"];
  const browser = await chromium.launch({ executablePath, args });
  const tab = await browser.newPage({ viewport: { width: 900, height: 600 }, reducedMotion: "reduce" });
  tab.setDefaultTimeout(60_000);
  const found = { asked: [], wrong: [] };
  tab.on("request", (request) => /^https?:|^wss?:/.test(request.url()) && request.url() !== HOST && found.asked.push(request.url()));
  tab.on("console", (message) => message.type() === "error" && found.wrong.push(message.text()));
  tab.on("pageerror", (error) => found.wrong.push(String(error)));
  await tab.route("**/*", (route) => route.fulfill({ contentType: "text/html", body: "<!doctype html><title>cell</title><div id=cell></div>" }));
  await tab.goto(HOST);
  await tab.evaluate(mount, traits);
  return {
    browser, tab, found,
    set: (values) => tab.evaluate((one) => Object.entries(one).forEach(([name, value]) => window.model.set(name, value)), values),
    count: () => tab.evaluate(() => window.model.saved.length),
    async said(before) {
      await tab.waitForFunction((count) => window.model.saved.length > count, before, { polling: 100 });
      await tab.waitForTimeout(400);
      return tab.evaluate(() => window.model.saved.at(-1));
    },
  };
}
