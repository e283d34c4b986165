// What all tests here need: a server of their own, browsers, and pictures to look at when something fails.

import { spawn } from "node:child_process";
import { once } from "node:events";
import { mkdir, mkdtemp, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { createInterface } from "node:readline";
import puppeteer from "puppeteer-core";

const ROOT = path.resolve(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "../..");
const SCREENSHOTS = path.join(ROOT, "target/clients");

/** Long enough for a busy machine; nothing here is slow by itself. */
const PATIENCE_MS = 60_000;

/** What cargo has built, unless the environment names another program. */
const program = (profile) => process.env.RASTERD_PROGRAM ?? path.join(ROOT, "target", profile, "rasterd");

/** A server, by default on a port of its own. */
export class Server {
  static async start({ listen = "127.0.0.1:0", profile = "debug" } = {}) {
    const server = new Server();
    server.process = spawn(program(profile), ["--listen", listen], { stdio: ["ignore", "ignore", "pipe"] });
    server.address = await new Promise((resolve, reject) => {
      createInterface(server.process.stderr).on("line", (line) => {
        const address = /listening address=(\S+)/.exec(line);
        if (address) resolve(address[1]);
      });
      server.process.once("error", reject);
      server.process.once("exit", (code) => reject(new Error(`the server ended with ${code}`)));
    });
    return server;
  }

  get url() {
    return `http://${this.address}`;
  }

  /** A request with a JSON body, if any; throws unless it succeeds. */
  async ask(method, target, json) {
    const headers = json === undefined ? {} : { "Content-Type": "application/json" };
    const response = await fetch(this.url + target, { method, headers, body: JSON.stringify(json) });
    if (!response.ok) throw new Error(`${method} ${target}: ${await response.text()}`);
    return response;
  }

  async json(target) {
    return (await this.ask("GET", target)).json();
  }

  /** The value of one line of `/metrics`. */
  async metric(line) {
    const text = await (await this.ask("GET", "/metrics")).text();
    const found = text.split("\n").find((other) => other.startsWith(`rasterd_${line} `));
    if (!found) throw new Error(`no ${line} in ${text}`);
    return Number(found.split(" ").at(-1));
  }

  async stop() {
    if (this.process.exitCode !== null) return;
    this.process.kill("SIGTERM");
    await once(this.process, "exit");
  }
}

/** Chromium over the DevTools protocol, without a window. */
export function chromium() {
  const args = ["--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"];
  return puppeteer.launch({ executablePath: "/usr/bin/chromium", args, protocolTimeout: PATIENCE_MS });
}

/** Firefox over WebDriver BiDi, without a window and with a profile of its own. */
export async function firefox() {
  const home = await mkdtemp(path.join(tmpdir(), "rasterd-firefox-"));
  const browser = await puppeteer.launch({
    browser: "firefox",
    executablePath: "/usr/bin/firefox-esr",
    env: { ...process.env, HOME: home },
    protocolTimeout: PATIENCE_MS,
  });
  browser.once("disconnected", () => rm(home, { recursive: true, force: true }));
  return browser;
}

/** What `check` answers as soon as that is something true. */
export async function until(what, check, patienceMs = PATIENCE_MS) {
  const end = Date.now() + patienceMs;
  for (;;) {
    const answer = await check();
    if (answer) return answer;
    if (Date.now() > end) throw new Error(`waited in vain: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

/** Runs `test` on a new page of `browser`; if it fails, keeps a screenshot. */
export async function onPage(browser, name, test) {
  const page = await browser.newPage();
  try {
    return await test(page);
  } catch (error) {
    error.message += `\n(${await keepScreenshot(page, name)})`;
    throw error;
  } finally {
    await page.close().catch(() => {});
  }
}

/** Where the screenshot is, or why there is none: what the test has failed of matters more. */
async function keepScreenshot(page, name) {
  const file = path.join(SCREENSHOTS, `${name.replaceAll(/[^a-z0-9]+/gi, "-")}.png`);
  try {
    await mkdir(SCREENSHOTS, { recursive: true });
    await writeFile(file, await page.screenshot());
    return `screenshot: ${path.relative(ROOT, file)}`;
  } catch (error) {
    return `no screenshot: ${error.message}`;
  }
}

/** The pixels of an encoded picture, as a browser's page reads them: `{width, height, data}`, RGBA. */
export async function decode(page, bytes) {
  const base64 = Buffer.from(bytes).toString("base64");
  const { width, height, data } = await page.evaluate(async (base64) => {
    const encoded = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([encoded]));
    const canvas = new OffscreenCanvas(picture.width, picture.height);
    const context = canvas.getContext("2d");
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, picture.width, picture.height);
    let text = "";
    for (let i = 0; i < data.length; i += 0x8000) text += String.fromCharCode(...data.subarray(i, i + 0x8000));
    return { width: picture.width, height: picture.height, data: btoa(text) };
  }, base64);
  return { width, height, data: Buffer.from(data, "base64") };
}
